// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Charts as SVG text: a picture that holds frames with axes, and what is drawn into them in their own units.
namespace aeolis::server::campaign {

struct Axis {
    std::string label;
    double from = 0.0, to = 1.0;
};

/// `values` of 1, 2 or 5 times a power of ten within the axis, about `wanted` of them.
struct Ticks {
    std::vector<double> values;
    int digits = 0;  ///< behind the point
};
Ticks ticks_of(const Axis& axis, int wanted);

/// The whole picture: what begins it and what ends it.
std::string svg_begin(double width, double height, std::string_view title, std::string_view subtitle);
std::string svg_end();

/// A frame with two axes at a place of the picture. Each function gives SVG text; what lies outside the frame is cut
/// off.
class Chart {
  public:
    struct Place {
        double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
    };
    /// `id` is unique in the picture.
    Chart(std::string id, const Place& place, Axis x, Axis y);

    std::string begin() const;  ///< ground, grid and labels; then what is drawn, until end()
    std::string end() const;

    std::string dot(double x, double y) const;
    std::string bar(double x_from, double x_to, double y) const;
    /// A region that is wanted, with its name.
    std::string wanted(double x_from, double x_to, double y_from, double y_to, std::string_view name) const;
    /// An ellipse of full axes in x's unit, its major axis from the y axis toward the x axis; scales must be equal.
    std::string ellipse(double x, double y, double major, double minor, double azimuth_deg) const;
    std::string cross(double x, double y, std::string_view name) const;

  private:
    double px(double x) const;
    double py(double y) const;

    std::string id_;
    Place place_;
    Axis x_, y_;
};

}  // namespace aeolis::server::campaign
