// Sentences that quote what a file or a user gave, which may be of any length.
#pragma once

#include <string>

namespace luxel {
inline namespace base {

/// The text with the middle of each word over 400 bytes, and all after `most_bytes`, taken out; it
/// says how many bytes are missing. Characters of UTF-8 stay whole. '?' stands for control
/// characters but line breaks and tabs: terminals obey them.
std::string short_message(const std::string& text, size_t most_bytes = 4000);

}  // namespace base
}  // namespace luxel
