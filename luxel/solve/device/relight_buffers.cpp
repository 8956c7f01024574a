#include "luxel/solve/device/relight_buffers.h"

#include <algorithm>

#include "luxel/base/check.h"
#include "luxel/solve/device/relight_shared.h"
#include "luxel/solve/matrix/bc1_block.h"

namespace luxel::device {
namespace {

constexpr std::string_view kWhat = "the buffer of patches";

using on_device::Cluster, on_device::Moments, on_device::RelightSetup;

// As shaders/relight_steps.comp reads them.
static_assert(sizeof(matrix::Hierarchical::Far) == 32 && sizeof(matrix::Hierarchical::Near) == 12);
static_assert(sizeof(matrix::Hierarchical::Up) == 48 && sizeof(matrix::Bc1::Kept) == 8);

/// Sends what it is given to the device, and remembers the first failure.
class Sender {
 public:
  Sender(gpu::Commands& commands, RelightBuffers& to) : commands_(commands), to_(to) {}

  template <class T>
  VkDeviceAddress send(std::span<const T> values) {
    static constexpr T kNone{};  // a buffer is never empty
    if (values.empty()) values = {&kNone, 1};
    return hold(gpu::uploaded(commands_, std::as_bytes(values), kWhat));
  }
  template <class T>
  VkDeviceAddress send(const std::vector<T>& values) {
    return send(std::span<const T>(values));
  }
  /// Room that the device alone uses.
  VkDeviceAddress room(size_t bytes) { return hold(make(bytes, gpu::Access::device)); }
  /// Room that others ask for by name.
  void make(size_t bytes, gpu::Access access, gpu::Buffer& out) {
    auto made = make(bytes, access);
    if (made)
      out = std::move(*made);
    else if (status_)
      status_ = Failure{made.error()};
  }
  const Status& status() const { return status_; }

 private:
  Result<gpu::Buffer> make(size_t bytes, gpu::Access access) {
    return gpu::make_buffer(commands_.device(), std::max<size_t>(bytes, 16), access, kWhat);
  }
  VkDeviceAddress hold(Result<gpu::Buffer> buffer) {
    if (!buffer) {
      if (status_) status_ = Failure{buffer.error()};
      return 0;
    }
    to_.held.push_back(std::move(*buffer));
    return to_.held.back().address;
  }

  gpu::Commands& commands_;
  RelightBuffers& to_;
  Status status_;
};

std::vector<float> spread(const std::vector<Rgb>& colors) {
  std::vector<float> out;
  for (const Rgb& c : colors) out.insert(out.end(), {c.x, c.y, c.z});
  return out;
}

void send_patches(const matrix::RelightData& data, Sender& to, RelightBuffers& out,
                  RelightSetup& s) {
  const size_t n = data.size(), bytes = n * sizeof(Rgb);
  s.reflectance = to.send(data.reflectance), s.emission = to.send(data.emission);
  s.area = to.send(data.area_m2), s.sky = to.send(data.sky);
  s.material = to.send(data.material), s.first_probe = to.send(data.first_probe);
  s.first_glow = to.send(data.glow.first), s.glow_material = to.send(data.glow.material);
  s.glow = to.send(data.glow.irradiance);
  s.glow_is_kept = !data.glow.first.empty();
  s.mean_emission = to.send(spread(matrix::mean_emission_of(data)));
  to.make(data.probe.size() * sizeof(Rgb), gpu::Access::device, out.at_probe);
  to.make(bytes, gpu::Access::device, out.direct),
      to.make(bytes, gpu::Access::device, out.indirect);
  to.make(3 * sizeof(float) * data.material_name.size(), gpu::Access::from_host,
          out.radiosity_of_material);
  s.at_probe = out.at_probe.address, s.direct = out.direct.address;
  s.indirect = out.indirect.address;
  s.radiosity_of_material = out.radiosity_of_material.address;
  for (VkDeviceAddress* room : {&s.straight, &s.sent, &s.radiosity, &s.product, &s.irradiance,
                                &s.first_product, &s.gathered})
    *room = to.room(bytes);
  s.patch_count = out.patches = uint32_t(n);
}

void send_places(const matrix::Target& target, Sender& to, RelightBuffers& out, RelightSetup& s) {
  out.places = uint32_t(target.transfer.size());
  s.first_transfer = to.send(target.transfer.first);
  s.transfer_patch = to.send(target.transfer.patch);
  s.transfer_weight = to.send(target.transfer.weight);
  to.make(out.places * sizeof(Rgb), gpu::Access::device, out.at_place);
  s.at_place = out.at_place.address;
}

void send_clusters(const matrix::Hierarchical& m, Sender& to, RelightBuffers& out,
                   RelightSetup& s) {
  std::vector<Cluster> clusters;
  for (const matrix::Cluster& c : m.clusters) clusters.push_back({c.first, c.end, c.child, 0});
  std::vector<uint32_t> by_depth, leaves;
  uint32_t deepest = 0;
  for (uint32_t c = 0; c < m.clusters.size(); ++c) {
    deepest = std::max(deepest, m.clusters[c].depth);
    if (m.clusters[c].is_leaf()) {
      leaves.push_back(c);
      continue;
    }
    for (uint32_t half = 0; half < 2; ++half) clusters[m.clusters[c].child + half].parent = c;
  }
  for (uint32_t depth = 0; depth <= deepest; ++depth) {
    const auto first = uint32_t(by_depth.size());
    for (uint32_t c = 0; c < m.clusters.size(); ++c)
      if (m.clusters[c].depth == depth) by_depth.push_back(c);
    out.depths.push_back({first, uint32_t(by_depth.size()) - first});
  }
  out.clusters = uint32_t(clusters.size()), out.leaves = uint32_t(leaves.size());
  s.clusters = to.send(clusters), s.by_depth = to.send(by_depth), s.leaves = to.send(leaves);
}

void send_hierarchy(const matrix::Hierarchical& m, Sender& to, RelightBuffers& out,
                    RelightSetup& s) {
  send_clusters(m, to, out, s);
  s.up = to.send(m.up), s.phi = to.send(m.phi);
  s.first_far = to.send(m.first_far), s.far = to.send(m.far);
  s.first_near = to.send(m.first_near), s.near = to.send(m.near);
  std::vector<uint32_t> entries((m.entries.size() + 3) / 4);
  for (size_t k = 0; k < m.entries.size(); ++k)
    entries[k / 4] |= uint32_t(m.entries[k]) << (8 * (k % 4));
  s.entries = to.send(entries);
  s.moments_sent = to.room(m.clusters.size() * sizeof(Moments));
  s.moments_received = to.room(m.clusters.size() * sizeof(Moments));
}

void send_coarse(const matrix::CoarseScene& coarse, Sender& to, RelightBuffers& out,
                 RelightSetup& s) {
  const size_t n = coarse.count();
  // The patches of each cluster, in their order.
  std::vector<uint32_t> first(n + 1), of(coarse.cluster_of.size());
  for (const uint32_t c : coarse.cluster_of) ++first[c + 1];
  for (size_t c = 0; c < n; ++c) first[c + 1] += first[c];
  std::vector<uint32_t> next = first;
  for (uint32_t i = 0; i < of.size(); ++i) of[next[coarse.cluster_of[i]]++] = i;
  std::vector<float> response;
  for (const std::vector<float>& channel : coarse.response)
    response.insert(response.end(), channel.begin(), channel.end());
  out.coarse = s.coarse_count = uint32_t(n);
  s.cluster_of = to.send(coarse.cluster_of);
  s.first_of_coarse = to.send(first), s.of_coarse = to.send(of), s.response = to.send(response);
  s.power = to.room(n * sizeof(Rgb)), s.late = to.room(n * sizeof(Rgb));
}

void send_blocks(const matrix::Bc1& m, Sender& to, RelightBuffers& out, RelightSetup& s) {
  const std::array<float, 256> values = matrix::byte_values(m.log_range);
  s.blocks = to.send(m.blocks), s.row = to.send(m.row), s.column = to.send(m.column);
  s.row_scale = to.send(m.row_scale), s.column_scale = to.send(m.column_scale);
  s.first_kept = to.send(m.first_kept), s.kept = to.send(m.kept);
  s.byte_values = to.send(std::span<const float>(values));
  s.kept_unit = {m.kept_unit[0], m.kept_unit[1], m.kept_unit[2]};
  out.block_rows = s.blocks_per_row = uint32_t(m.blocks_per_row());
}

}  // namespace

Result<RelightBuffers> upload_relight_data(gpu::Commands& commands,
                                           const matrix::RelightData& data) {
  const auto* hierarchical = std::get_if<matrix::HierarchicalCodec>(&data.codec);
  const auto* bc1 = std::get_if<matrix::Bc1Codec>(&data.codec);
  if ((!hierarchical && !bc1) || data.size() == 0)
    return fail(ErrorCode::unsupported,
                "relighting on the device needs a file with patches and the codec hierarchical or "
                "bc1: make the file again with one of them, or relight on the processor");
  RelightBuffers out;
  RelightSetup setup{};
  Sender to(commands, out);
  send_patches(data, to, out, setup);
  send_places(data.target, to, out, setup);
  if (hierarchical) {
    send_hierarchy(hierarchical->matrix, to, out, setup);
    send_coarse(hierarchical->coarse, to, out, setup);
  } else {
    send_blocks(bc1->matrix, to, out, setup);
  }
  LUXEL_TRY_STATUS(to.status());
  LUXEL_TRY(out.setup, gpu::uploaded(commands, std::as_bytes(std::span(&setup, 1)), kWhat));
  return out;
}

}  // namespace luxel::device
