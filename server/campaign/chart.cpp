// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/chart.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::server::campaign {
namespace {

std::string escaped(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        if (c == '<')
            safe += "&lt;";
        else if (c == '>')
            safe += "&gt;";
        else if (c == '&')
            safe += "&amp;";
        else
            safe += c;
    }
    return safe;
}

constexpr const char* style = "text{font:13px 'Helvetica Neue',Arial,sans-serif;fill:#3d4450}"
                              ".title{font-size:18px;font-weight:600;fill:#171b22}.subtitle{fill:#69717e}"
                              ".grid{stroke:#e7eaef;stroke-width:1}.frame{fill:none;stroke:#aab1bd;stroke-width:1}"
                              ".dot{fill:#2a6fb8;fill-opacity:.45}.bar{fill:#2a6fb8;fill-opacity:.75}"
                              ".wanted{fill:#3a9a62;fill-opacity:.09;stroke:#3a9a62;stroke-dasharray:5 4}"
                              ".name{fill:#2c7a4d;font-size:12px}.ellipse{fill:none;stroke:#d97706;stroke-width:2}"
                              ".cross{stroke:#c22f3d;stroke-width:2}.crossname{fill:#c22f3d;font-size:12px}";

}  // namespace

Ticks ticks_of(const Axis& axis, int wanted) {
    Ticks ticks;
    const double span = axis.to - axis.from;
    if (!(span > 0.0) || wanted < 1) return ticks;
    const double rough = span / wanted;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double mantissa = rough / power;
    const double step = power * (mantissa < 1.5 ? 1.0 : mantissa < 3.5 ? 2.0 : mantissa < 7.5 ? 5.0 : 10.0);
    ticks.digits = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1.0e-9)));
    for (double i = std::ceil(axis.from / step - 1.0e-9); i * step <= axis.to + 1.0e-9 * span; ++i)
        ticks.values.push_back(i == 0.0 ? 0.0 : i * step);
    return ticks;
}

std::string svg_begin(double width, double height, std::string_view title, std::string_view subtitle) {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
        "<style>{2}</style>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n"
        "<text class=\"title\" x=\"24\" y=\"34\">{3}</text>\n"
        "<text class=\"subtitle\" x=\"24\" y=\"56\">{4}</text>\n",
        width, height, style, escaped(title), escaped(subtitle));
}

std::string svg_end() {
    return "</svg>\n";
}

Chart::Chart(std::string id, const Place& place, Axis x, Axis y)
    : id_(std::move(id)), place_(place), x_(std::move(x)), y_(std::move(y)) {}

double Chart::px(double x) const {
    return place_.left + (x - x_.from) / (x_.to - x_.from) * place_.width;
}
double Chart::py(double y) const {
    return place_.top + (y_.to - y) / (y_.to - y_.from) * place_.height;
}

std::string Chart::begin() const {
    const double right = place_.left + place_.width, bottom = place_.top + place_.height;
    std::string text;
    const auto across = ticks_of(x_, static_cast<int>(place_.width / 70.0));
    for (const double x : across.values)
        text += fmt::format("<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\"/>"
                            "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4:.{5}f}</text>\n",
                            px(x), place_.top, bottom, bottom + 19.0, x, across.digits);
    const auto up = ticks_of(y_, static_cast<int>(place_.height / 70.0));
    for (const double y : up.values)
        text += fmt::format("<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{2:.1f}\" x2=\"{1:.1f}\" y2=\"{2:.1f}\"/>"
                            "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.{6}f}</text>\n",
                            place_.left, right, py(y), place_.left - 8.0, py(y) + 4.5, y, up.digits);
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n"
                        "<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                        place_.left + 0.5 * place_.width, bottom + 42.0, escaped(x_.label), place_.left - 50.0,
                        place_.top + 0.5 * place_.height, escaped(y_.label));
    text += fmt::format("<clipPath id=\"{0}\"><rect x=\"{1:.1f}\" y=\"{2:.1f}\" width=\"{3:.1f}\" height=\"{4:.1f}\"/>"
                        "</clipPath>\n<rect class=\"frame\" x=\"{1:.1f}\" y=\"{2:.1f}\" width=\"{3:.1f}\" "
                        "height=\"{4:.1f}\"/>\n<g clip-path=\"url(#{0})\">\n",
                        id_, place_.left, place_.top, place_.width, place_.height);
    return text;
}

std::string Chart::end() const {
    return "</g>\n";
}

std::string Chart::dot(double x, double y) const {
    return fmt::format("<circle class=\"dot\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\"/>\n", px(x), py(y));
}

std::string Chart::bar(double x_from, double x_to, double y) const {
    const double width = std::max(px(x_to) - px(x_from) - 1.0, 0.5);
    return fmt::format("<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
                       px(x_from) + 0.5, py(y), width, py(y_.from) - py(y));
}

std::string Chart::wanted(double x_from, double x_to, double y_from, double y_to, std::string_view name) const {
    return fmt::format("<rect class=\"wanted\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>"
                       "<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                       px(x_from), py(y_to), px(x_to) - px(x_from), py(y_from) - py(y_to), px(x_from) + 8.0,
                       py(y_to) + 18.0, escaped(name));
}

std::string Chart::ellipse(double x, double y, double major, double minor, double azimuth_deg) const {
    const double pixels = place_.width / (x_.to - x_.from);
    return fmt::format("<ellipse class=\"ellipse\" rx=\"{:.1f}\" ry=\"{:.1f}\" transform=\"translate({:.1f} {:.1f}) "
                       "rotate({:.2f})\"/>\n",
                       0.5 * major * pixels, 0.5 * minor * pixels, px(x), py(y), azimuth_deg - 90.0);
}

std::string Chart::cross(double x, double y, std::string_view name) const {
    return fmt::format("<path class=\"cross\" d=\"M{0:.1f} {1:.1f}h16m-8 -8v16\"/>"
                       "<text class=\"crossname\" x=\"{2:.1f}\" y=\"{3:.1f}\">{4}</text>\n",
                       px(x) - 8.0, py(y), px(x) + 9.0, py(y) - 8.0, escaped(name));
}

}  // namespace aeolis::server::campaign
