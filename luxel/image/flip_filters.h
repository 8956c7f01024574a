// The spatial filters of FLIP: how the eye blurs, and where it sees edges and points.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace luxel::image {

/// A one-dimensional filter with taps at -radius .. radius.
struct Kernel {
  int radius = 0;
  std::vector<float> tap;
};

/// Everything here is separable. Blue-yellow is a sum of two Gaussians.
struct FlipFilters {
  Kernel achromatic, red_green;
  std::array<Kernel, 2> blue_yellow;
  std::array<float, 2> blue_yellow_weight{};
  Kernel smooth, first, second;  ///< a Gaussian, and its derivatives normalised as in the paper
  int radius = 0;                ///< the largest
};
FlipFilters make_flip_filters(double pixels_per_degree);

/// An image as planes of Y, X - Y and Y - Z.
struct OpponentImage {
  OpponentImage(int w, int h) : width(w), height(h) {
    for (auto& p : plane) p.resize(size_t(w) * size_t(h));
  }
  int width, height;
  std::array<std::vector<float>, 3> plane;
};

/// One row behind all filters; edges and points as their x and y parts.
struct FilteredRow {
  explicit FilteredRow(int width) {
    for (auto* group : {&edge, &point})
      for (auto& part : *group) part.resize(size_t(width));
    for (auto& channel : opponent) channel.resize(size_t(width));
  }
  std::array<std::vector<float>, 3> opponent;
  std::array<std::vector<float>, 2> edge, point;
};

/// The rows begin .. end of an image and those around them that their filters reach, filtered along
/// x. Outside the image its border goes on.
class FilteredBand {
 public:
  FilteredBand(const FlipFilters& filters, const OpponentImage& image, int begin, int end);
  /// Filters along y. begin <= y < end.
  void filter_row(int y, FilteredRow& out) const;

 private:
  enum Part { achromatic, red_green, blue_yellow0, blue_yellow1, smooth, first, second, kParts };
  const float* row(Part part, int y) const;
  void add_column(Part part, const Kernel& kernel, int y, float weight,
                  std::vector<float>& out) const;

  const FlipFilters& filters_;
  int width_, top_;
  std::array<std::vector<float>, kParts> parts_;
};

}  // namespace luxel::image
