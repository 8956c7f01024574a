// The page of view_page.h as export/web/ bundles it when luxel is built.
#pragma once

#include <string_view>

namespace luxel::export_ {

/// HTML up to the elements that carry the scene, and from there on. Empty where the build had no
/// node, npm or network to bundle it with.
std::string_view view_page_before_data();
std::string_view view_page_after_data();

}  // namespace luxel::export_
