// A sun that takes its sky along.
#pragma once

#include "luxel/view/edit/edits.h"

namespace luxel::view {

/// A lamp becomes another one. Where it is the sun of the sky and stands elsewhere, the sky becomes
/// the one that has its sun there, to a hundredth of a degree, or the one that is `asked` for. Its
/// light becomes that of this sky, unless it was changed by hand.
LampSet lamp_set(uint32_t lamp, const Lamp& to, const std::optional<SkyAsked>& asked,
                 const EditDesk& desk);

/// True while a lamp is as its sky has it, so that `--sky` brings it back.
bool is_of_sky(uint32_t lamp, const ReadScene& read, const SceneNow& now);

}  // namespace luxel::view
