// A graphics device that traces rays for gather; luxel/solve/device/ has one. Gather itself knows
// no graphics.
#pragma once

#include <span>

#include "luxel/base/progress.h"
#include "luxel/base/result.h"

namespace luxel::light {
class LightDevice;
}  // namespace luxel::light

namespace luxel::gather {

struct Gathered;
struct RadiosityMap;
struct TraceParams;
struct TracedHits;
struct TraceScene;

/// Works direct light out, traces rounds of rays, and keeps where they land. One solution at a time
/// uses it. It keeps parts, which the processor finds, but looks for none, and shows nobody how a
/// round grows.
class RayDevice {
 public:
  virtual ~RayDevice() = default;

  /// Takes a scene, in place of any before; what follows is about this one. It is kept by reference
  /// until forget(). Errors: it cannot trace it (ErrorCode::unsupported), no memory, the device is
  /// lost.
  virtual Status begin(const TraceScene& in) = 0;

  /// The device that lights places of the scene until forget(). Null where it does not know all
  /// that shines there: direct light is the processor's then. Errors: no memory, the device is
  /// lost.
  virtual Result<light::LightDevice*> light_device(const TraceScene& in) = 0;

  /// trace_more(), but that the hits stay on the device until forget(), and sweep() has what they
  /// bring: the store of the round, which the caller adds, is empty. All rounds of `hits` are the
  /// device's. Some elements. In params neither keep, earlier nor layers. Errors:
  /// ErrorCode::unsupported for too many rays, cancelled, no memory, the device is lost.
  virtual Status trace(const TraceScene& in, std::span<const uint16_t> target,
                       const TraceParams& params, TracedHits& hits, Progress& progress) = 0;

  /// Light that each element's rays bring from the map, of those rounds of trace() that count.
  /// Errors: no memory, the device is lost.
  virtual Status sweep(const RadiosityMap& map, std::span<Gathered> out) = 0;

  /// Gives the memory of the scene and of trace() back.
  virtual void forget() = 0;
};

}  // namespace luxel::gather
