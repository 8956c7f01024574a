// Light that patches send to each other: the steps of luxel/solve/matrix/relighter.h, one of which a
// pipeline runs. ../device_relighter.cpp has the order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "luxel/gpu/shared_language.h"

// Functions of the parent in terms of its half's: of[4 * b + a], a the parent's.
struct Up {
  float of[12];
};
IN_BUFFER(Ups, Up);

// matrix::Hierarchical::Far: twelve numbers of 16 bits, [4 * b + a], a the receiver's function.
struct Far {
  uint coefficients[6];
  float scale;
  uint sender;
};
IN_BUFFER(Fars, Far);

// matrix::Hierarchical::Near
struct Near {
  uint sender, entry;
  float scale;
};
IN_BUFFER(Nears, Near);

// matrix::Bc1::Kept: three halves, and the place of the column.
struct Kept {
  uint red_green, blue_place;
};
IN_BUFFER(AllKept, Kept);

#include "luxel/solve/device/relight_shared.h"

layout(local_size_x = kRelightThreads) in;
layout(constant_id = 0) const uint kStep = 0;

shared vec3 sums[3][kRelightThreads];

// The sum over the threads of a group, in a fixed order; each thread calls it.
vec3 sum_over_group(uint which, uint lane) {
  for (uint half_of = kRelightThreads / 2; half_of > 0; half_of /= 2) {
    barrier();
    if (lane < half_of) sums[which][lane] += sums[which][lane + half_of];
  }
  barrier();
  return sums[which][0];
}

vec3 of_material(Floats values, uint m) { return vec3(values.at[3 * m], values.at[3 * m + 1], values.at[3 * m + 2]); }

// B_e of a patch whose material's mean radiosity is to be `wanted` and was `mean`.
vec3 emission_of(vec3 baked, vec3 mean, vec3 wanted) {
  return mix(wanted, baked / max(mean, vec3(1e-37)) * wanted, greaterThan(mean, vec3(0)));
}

void begin_patch(uint i) {
  vec3 sum = vec3(0);
  uint begin = setup.first_probe.at[i], end = setup.first_probe.at[i + 1];
  for (uint k = begin; k < end; ++k) sum += setup.at_probe.at[k];
  vec3 direct = sum / max(1.0, float(end - begin));
  vec3 straight = background * (3.14159265358979323846 * setup.sky.at[i]);
  uint m = setup.material.at[i];
  if (setup.glow_is_kept != 0)
    for (uint k = setup.first_glow.at[i]; k < setup.first_glow.at[i + 1]; ++k)
      straight += setup.glow.at[k] * of_material(setup.radiosity_of_material, setup.glow_material.at[k]);
  vec3 sent = setup.reflectance.at[i] * (direct + straight);
  if (setup.glow_is_kept == 0)
    sent += emission_of(setup.emission.at[i], of_material(setup.mean_emission, m),
                        of_material(setup.radiosity_of_material, m));
  setup.direct.at[i] = direct, setup.straight.at[i] = straight;
  setup.sent.at[i] = sent, setup.radiosity.at[i] = sent;
  setup.irradiance.at[i] = vec3(0);
}

void send_leaf(uint c) {
  Cluster cluster = setup.clusters.at[c];
  Moments m = Moments(vec3[3](vec3(0), vec3(0), vec3(0)));
  if (cluster.child == 0)
    for (uint i = cluster.first; i < cluster.end; ++i) {
      vec3 power = setup.radiosity.at[i] * setup.area.at[i];
      for (uint a = 0; a < 3; ++a) m.of[a] += power * setup.phi.at[3 * i + a];
    }
  setup.moments_sent.at[c] = m;
}

void send_up(uint p) {
  Cluster cluster = setup.clusters.at[p];
  if (cluster.child == 0) return;
  Moments sum = Moments(vec3[3](vec3(0), vec3(0), vec3(0)));
  for (uint c = cluster.child; c < cluster.child + 2; ++c) {
    Up up = setup.up.at[c];
    Moments from = setup.moments_sent.at[c];
    for (uint b = 0; b < 3; ++b)
      for (uint a = 0; a < 3; ++a) sum.of[a] += up.of[4 * b + a] * from.of[b];
  }
  setup.moments_sent.at[p] = sum;
}

float coefficient(Far far, uint k) { return float(bitfieldExtract(int(far.coefficients[k / 2]), int(16 * (k % 2)), 16)); }

void receive_far(uint c, uint lane) {
  vec3 sum[3] = vec3[3](vec3(0), vec3(0), vec3(0));
  for (uint k = setup.first_far.at[c] + lane; k < setup.first_far.at[c + 1]; k += kRelightThreads) {
    Far far = setup.far.at[k];
    Moments from = setup.moments_sent.at[far.sender];
    for (uint b = 0; b < 3; ++b) {
      vec3 scaled = from.of[b] * far.scale;
      for (uint a = 0; a < 3; ++a) sum[a] += coefficient(far, 4 * b + a) * scaled;
    }
  }
  Moments received;
  for (uint a = 0; a < 3; ++a) {
    sums[a][lane] = sum[a];
    received.of[a] = sum_over_group(a, lane);
  }
  if (lane == 0) setup.moments_received.at[c] = received;
}

// From its parent, by the transposed matrix.
void hand_down(uint c) {
  Up up = setup.up.at[c];
  Moments from = setup.moments_received.at[setup.clusters.at[c].parent], to = setup.moments_received.at[c];
  for (uint b = 0; b < 3; ++b)
    for (uint a = 0; a < 3; ++a) to.of[b] += up.of[4 * b + a] * from.of[a];
  setup.moments_received.at[c] = to;
}

float entry_at(uint k) { return float(bitfieldExtract(setup.entries.at[k / 4], int(8 * (k % 4)), 8)); }

// Eight threads share what one patch of the leaf receives from near ones.
void receive_leaf(uint c, uint lane) {
  Cluster leaf = setup.clusters.at[c];
  uint own = lane % 8, slice = lane / 8;
  vec3 sum = vec3(0);
  for (uint k = setup.first_near.at[c] + slice; k < setup.first_near.at[c + 1]; k += kRelightThreads / 8) {
    Near near = setup.near.at[k];
    Cluster sender = setup.clusters.at[near.sender];
    uint entry = near.entry + own;
    for (uint j = sender.first; j < sender.end; ++j, entry += 8)
      sum += setup.radiosity.at[j] * (near.scale * entry_at(entry));
  }
  sums[0][lane] = sum;
  barrier();
  uint i = leaf.first + own;
  if (slice != 0 || i >= leaf.end) return;
  for (uint k = 1; k < kRelightThreads / 8; ++k) sum += sums[0][8 * k + own];
  Moments received = setup.moments_received.at[c];
  for (uint a = 0; a < 3; ++a) sum += setup.phi.at[3 * i + a] * received.of[a];
  setup.product.at[i] = max(sum, vec3(0));  // smooth functions may fall below nothing
}

void power_of(uint s, uint lane) {
  vec3 sum = vec3(0);
  for (uint k = setup.first_of_coarse.at[s] + lane; k < setup.first_of_coarse.at[s + 1]; k += kRelightThreads) {
    uint i = setup.of_coarse.at[k];
    sum += setup.reflectance.at[i] * setup.gathered.at[i] * setup.area.at[i];
  }
  sums[0][lane] = sum;
  sum = sum_over_group(0, lane);
  if (lane == 0) setup.power.at[s] = sum;
}

void late_of(uint s, uint lane) {
  uint n = setup.coarse_count;
  vec3 sum = vec3(0);
  for (uint t = lane; t < n; t += kRelightThreads)
    sum += vec3(setup.response.at[t * n + s], setup.response.at[n * n + t * n + s],
                setup.response.at[2 * n * n + t * n + s]) * setup.power.at[t];
  sums[0][lane] = sum;
  sum = sum_over_group(0, lane);
  if (lane == 0) setup.late.at[s] = sum;
}

vec3 light_at_place(uint place) {
  return setup.column_scale.at[place] * setup.sent.at[setup.column.at[place]];
}

// The four values that a channel's two ends stand for; `bits` of each end.
vec4 levels_of(uint a, uint b, uint bits) {
  uint low = a << (8 - bits) | a >> (2 * bits - 8), high = b << (8 - bits) | b >> (2 * bits - 8);
  return vec4(setup.byte_values.at[low], setup.byte_values.at[high], setup.byte_values.at[(2 * low + high) / 3],
              setup.byte_values.at[(low + 2 * high) / 3]);
}

vec3 kept_light(uint place, uint lane) {
  vec3 sum = vec3(0);
  for (uint k = setup.first_kept.at[place] + lane; k < setup.first_kept.at[place + 1]; k += kRelightThreads) {
    Kept kept = setup.kept.at[k];
    vec3 value = vec3(unpackHalf2x16(kept.red_green), unpackHalf2x16(kept.blue_place & 0xffffu).x);
    sum += value * light_at_place(kept.blue_place >> 16);
  }
  return sum * setup.kept_unit;
}

// Four rows of K: blocks of 4 x 4 entries, and what is kept besides.
void multiply_blocks(uint block_row, uint lane) {
  uint n = setup.patch_count;
  vec3 rest[4] = vec3[4](vec3(0), vec3(0), vec3(0), vec3(0));
  for (uint b = lane; b < setup.blocks_per_row; b += kRelightThreads) {
    uint at = 2 * (block_row * setup.blocks_per_row + b);
    uint ends = setup.blocks.at[at], indices = setup.blocks.at[at + 1];
    vec4 red = levels_of(ends >> 11 & 31, ends >> 27 & 31, 5), green = levels_of(ends >> 5 & 63, ends >> 21 & 63, 6),
         blue = levels_of(ends & 31, ends >> 16 & 31, 5);
    for (uint x = 0; x < 4; ++x) {
      uint place = 4 * b + x;
      if (place >= n) break;
      vec3 light = light_at_place(place);
      for (uint y = 0; y < 4; ++y) {
        uint index = indices >> (2 * (4 * y + x)) & 3;
        rest[y] += vec3(red[index], green[index], blue[index]) * light;
      }
    }
  }
  for (uint y = 0; y < 4; ++y) {
    uint place = 4 * block_row + y;
    sums[0][lane] = rest[y];
    vec3 of_blocks = sum_over_group(0, lane);
    barrier();
    sums[1][lane] = place < n ? kept_light(place, lane) : vec3(0);
    vec3 of_kept = sum_over_group(1, lane);
    if (lane == 0 && place < n) setup.product.at[setup.row.at[place]] = setup.row_scale.at[place] * of_blocks + of_kept;
    barrier();
  }
}

void light_place(uint i) {
  vec3 sum = vec3(0);
  for (uint k = setup.first_transfer.at[i]; k < setup.first_transfer.at[i + 1]; ++k)
    sum += setup.indirect.at[setup.transfer_patch.at[k]] * setup.transfer_weight.at[k];
  setup.at_place.at[i] = max(sum, vec3(0));
}

// A patch, between products.
void advance_patch(uint i) {
  vec3 product = setup.product.at[i];
  switch (kStep) {
    case kBeginSweeps:
      setup.first_product.at[i] = product, setup.irradiance.at[i] = product, setup.gathered.at[i] = product;
      break;
    case kForesee: {
      vec3 e = setup.irradiance.at[i] + setup.late.at[setup.cluster_of.at[i]];
      setup.irradiance.at[i] = e, setup.radiosity.at[i] = setup.reflectance.at[i] * e;
      break;
    }
    case kEndSweep: {
      vec3 now = setup.first_product.at[i] + product;
      setup.gathered.at[i] = now - setup.irradiance.at[i], setup.irradiance.at[i] = now;
      break;
    }
    case kBounce:
      setup.radiosity.at[i] = setup.sent.at[i] + setup.reflectance.at[i] * setup.irradiance.at[i];
      break;
    case kTakeProduct: setup.irradiance.at[i] = product; break;
    case kFinish: setup.indirect.at[i] = setup.irradiance.at[i] + setup.straight.at[i]; break;
  }
}

void main() {
  uint lane = gl_LocalInvocationID.x, group = first_group + gl_WorkGroupID.x, k = group * kRelightThreads + lane;
  switch (kStep) {
    case kReceiveFar: receive_far(first + group, lane); return;
    case kReceiveLeaves: receive_leaf(setup.leaves.at[first + group], lane); return;
    case kPowers: power_of(first + group, lane); return;
    case kLate: late_of(first + group, lane); return;
    case kBlocks: multiply_blocks(first + group, lane); return;
  }
  if (k >= count) return;
  switch (kStep) {
    case kPatches: begin_patch(k); break;
    case kSendLeaves: send_leaf(k); break;
    case kSendUp: send_up(setup.by_depth.at[first + k]); break;
    case kHandDown: hand_down(setup.by_depth.at[first + k]); break;
    case kPlaces: light_place(k); break;
    default: advance_patch(k); break;
  }
}
