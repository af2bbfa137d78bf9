// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

// Charts as SVG text: a picture with frames and axes; content is drawn in the axes' units.
namespace aeolis::server::campaign {

struct Axis {
    std::string label;
    double from = 0.0, to = 1.0;
};

/// Tick values within the axis at 1, 2 or 5 times a power of ten, about `wanted` of them.
struct Ticks {
    std::vector<double> values;
    int digits = 0;  ///< after the decimal point
};
Ticks ticks_of(const Axis& axis, int wanted);

/// The begin and the end of the whole picture.
std::string svg_begin(double width, double height, std::string_view title, std::string_view subtitle);
std::string svg_end();

/// A frame with two axes within the picture. Each function returns SVG text, clipped to the frame.
class Chart {
  public:
    struct Place {
        double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
    };
    /// @param id  unique in the picture
    Chart(std::string id, const Place& place, Axis x, Axis y);

    std::string begin() const;  ///< background, grid and labels; content follows until end()
    std::string end() const;

    std::string dot(double x, double y) const;
    std::string bar(double x_from, double x_to, double y) const;
    /// A desired region, with its name.
    std::string wanted(double x_from, double x_to, double y_from, double y_to, std::string_view name) const;
    /// An ellipse by its full axes in x's unit; azimuth from the y axis toward the x axis. The scales must be equal.
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
