// IES photometric files: how strongly a light shines in which direction. [LM63]
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "luxel/base/result.h"
#include "luxel/scene/light_profile.h"

namespace luxel::import {

/// A luminaire as an IES file describes it.
struct Ies {
  scene::LightProfile profile;        ///< all factors in, symmetries unfolded
  double lumens = 0;                  ///< lamps * lumens per lamp; 0: absolute photometry
  std::vector<std::string> warnings;  ///< one sentence each
};

/// An ANSI/IES LM-63 file of 1986, 1991, 1995, 2002 or 2019. Candela are multiplied by the
/// multiplier, the ballast factor and, up to 1991, the ballast-lamp factor. `name` is the file's,
/// for messages. Errors say file, line and value: no such file, TILT in a file of its own, numbers
/// missing or too many, not finite, negative or out of order, angles that cover no known symmetry.
Result<Ies> parse_ies(std::string_view text, const std::string& name);

/// Reads and parses a file. Errors: as parse_ies, and unreadable.
Result<Ies> read_ies(const std::filesystem::path& path);

}  // namespace luxel::import
