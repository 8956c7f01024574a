// A device forgets what it was given, however its use ends.
#pragma once

namespace luxel {
inline namespace base {

/// Calls forget() of a device in the end. `device`: null: there is none.
template <class Device>
struct ForgetAtEnd {
  Device* device;

  explicit ForgetAtEnd(Device* used) : device(used) {}
  ForgetAtEnd(const ForgetAtEnd&) = delete;
  ForgetAtEnd& operator=(const ForgetAtEnd&) = delete;
  ~ForgetAtEnd() {
    if (device) device->forget();
  }
};

}  // namespace base
}  // namespace luxel
