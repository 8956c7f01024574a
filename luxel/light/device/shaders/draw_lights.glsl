// Some of many lights, in proportion to what they bring: luxel/light/light_draw.h. The lights lie on
// a line; draws come one after the other, so that a shader has one place where it traces them.

// The tree is halved by number: it has fewer levels than this.
const int kDeepest = 32;

struct CutEntry {
  uint node;
  float importance, spread;
};

// light::LightDraw
struct Draw {
  uint leaf, count;
  float chance;
};

// Part of the line, which a node below the cut takes.
struct Part {
  uint node;
  double begin, expected;
};

// Where a receiver is among its draws.
struct Draws {
  bool punctual;  // of point and spot lights; else of triangles
  CutEntry cut[kMaxCut];
  uint cut_size, next;
  bool on_line;  // after the lights that are drawn for certain
  double per_ray, rays, rest, begin;
  Part parts[kDeepest];
  int part_count;
};

LightNode node_at(bool punctual, uint index) {
  if (punctual) return setup.punctual_nodes.at[index];
  return setup.nodes.at[index];
}

float importance_at(bool punctual, LightNode n, Receiver r) {
  if (!punctual || n.right_child != 0) return importance_of(group_of(n), r.position, r.normal);
  Incidence met = incidence_at(setup.punctual.at[setup.punctual_order.at[n.first]], r.position);
  return luminance(met.irradiance) * max(0.0, dot(met.towards, r.normal));
}

CutEntry entry_for(bool punctual, uint index, Receiver r) {
  LightNode n = node_at(punctual, index);
  CutEntry entry = CutEntry(index, importance_at(punctual, n, r), 0);
  if (n.right_child == 0) return entry;
  vec3 to = n.centre - r.position;
  float r2 = n.radius_m * n.radius_m;
  entry.spread = entry.importance * r2 / max(dot(to, to), r2);
  return entry;
}

// Splits the group whose members differ most, until there are most_cut entries; in the order of the
// tree.
void find_cut(inout Draws d, uint most_cut, Receiver r) {
  d.cut[0] = entry_for(d.punctual, 0, r);
  d.cut_size = 1;
  while (d.cut_size > 0 && d.cut_size < most_cut) {
    uint widest = 0;
    for (uint k = 1; k < d.cut_size; ++k)
      if (d.cut[k].spread > d.cut[widest].spread) widest = k;
    if (!(d.cut[widest].spread > 0)) break;
    uint parent = d.cut[widest].node;
    d.cut[widest] = d.cut[--d.cut_size];
    for (uint side = 0; side < 2; ++side) {
      CutEntry entry = entry_for(d.punctual, side == 0 ? parent + 1 : node_at(d.punctual, parent).right_child, r);
      if (entry.importance > 0) d.cut[d.cut_size++] = entry;
    }
  }
  for (uint k = 1; k < d.cut_size; ++k) {
    CutEntry entry = d.cut[k];
    uint to = k;
    for (; to > 0 && d.cut[to - 1].node > entry.node; --to) d.cut[to] = d.cut[to - 1];
    d.cut[to] = entry;
  }
}

// Shares `count` rays out.
Draws begin_draws(bool punctual, uint count, uint most_cut, float start, Receiver r) {
  Draws d;
  d.punctual = punctual, d.next = 0, d.on_line = false, d.part_count = 0;
  d.rays = 0, d.rest = 0, d.begin = start;
  find_cut(d, most_cut, r);
  double sum = 0;
  for (uint k = 0; k < d.cut_size; ++k) sum += d.cut[k].importance;
  d.per_ray = sum / double(count);
  if (!(d.per_ray > 0)) d.cut_size = 0;
  return d;
}

// Goes down the tree by one node; true where that is a light which is drawn.
bool go_down(inout Draws d, Receiver r, out Draw draw) {
  Part p = d.parts[--d.part_count];
  double count = floor(p.begin + p.expected) - floor(p.begin);
  if (count < 1) return false;
  LightNode n = node_at(d.punctual, p.node);
  draw = Draw(n.first, uint(count), float(min(double(1), p.expected)));
  if (n.right_child == 0) return true;
  double left = importance_at(d.punctual, node_at(d.punctual, p.node + 1), r);
  double right = importance_at(d.punctual, node_at(d.punctual, n.right_child), r);
  if (!(left + right > 0)) return false;
  double half_way = p.expected * left / (left + right);
  d.parts[d.part_count++] = Part(n.right_child, p.begin + half_way, p.expected - half_way);
  d.parts[d.part_count++] = Part(p.node + 1, p.begin, half_way);
  return false;
}

// Single lights that deserve a ray and more are off the line, and come first; true where the next
// entry of the cut is one.
bool take_certain(inout Draws d, out Draw draw) {
  CutEntry entry = d.cut[d.next];
  LightNode n = node_at(d.punctual, entry.node);
  double deserved = double(entry.importance) / d.per_ray;
  bool certain = n.right_child == 0 && deserved >= 1;
  if (certain)
    d.cut[d.next].importance = 0;
  else
    d.rest += entry.importance;
  draw = Draw(n.first, rounded(deserved), 1);
  ++d.next;
  return certain;
}

// The next light that is drawn; false: there is none any more.
bool next_draw(inout Draws d, Receiver r, out Draw draw) {
  for (;;) {
    if (d.part_count > 0) {
      if (go_down(d, r, draw)) return true;
    } else if (d.next < d.cut_size) {
      if (d.on_line) {
        CutEntry entry = d.cut[d.next++];
        if (entry.importance <= 0) continue;
        double expected = d.rays * double(entry.importance) / d.rest;
        d.parts[d.part_count++] = Part(entry.node, d.begin, expected);
        d.begin += expected;
      } else if (take_certain(d, draw)) {
        return true;
      }
    } else {
      if (d.on_line || !(d.rest > 0)) return false;
      d.on_line = true, d.next = 0;
      d.rays = max(double(1), floor(d.rest / d.per_ray + 0.5));
    }
  }
}
