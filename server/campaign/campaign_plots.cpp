// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_plots.hpp"

#include "server/campaign/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>

namespace aeolis::server::campaign {
namespace {

using Point = CampaignResults::Point;

// [facts] Dispersed landings
constexpr double mach_from = 1.4, mach_to = 2.2, pressure_from_Pa = 200.0, pressure_to_Pa = 750.0;
constexpr double vertical_from_mps = 0.65, vertical_to_mps = 0.85, horizontal_to_mps = 0.5;

struct Range {
    double from = 0.0, to = 0.0;
    void take(double value) {
        from = std::min(from, value);
        to = std::max(to, value);
    }
    void widen(double part) {
        const double by = part * std::max(to - from, 1.0e-9);
        from -= by;
        to += by;
    }
};

/// A picture being written to its file.
class Picture {
  public:
    explicit Picture(std::filesystem::path file) : file_(std::move(file)), stream_(file_, std::ios::binary) {}
    void add(const std::string& text) { stream_ << text; }
    Result<void> close() {
        stream_.close();
        if (stream_.fail()) return Error{file_.string() + ": cannot be written"};
        return {};
    }

  private:
    std::filesystem::path file_;
    std::ofstream stream_;
};

std::string whose(const Summary& summary, std::uint64_t count) {
    return fmt::format("{}, seed {}, {} cases", summary.scenario, summary.seed, count);
}

Result<void> plot_touchdown(CampaignResults& results, const Summary& summary, const std::filesystem::path& file) {
    const Ellipse& ellipse = summary.ellipse;
    const double half_km = 0.5 * ellipse.major_m * km;
    Range east, north;  // includes the target
    for (const double sign : {-1.0, 1.0}) {
        east.take(ellipse.east_m * km + sign * half_km);
        north.take(ellipse.north_m * km + sign * half_km);
    }
    const auto ranged = results.each_touchdown_m([&](Point at) {
        east.take(at.x * km);
        north.take(at.y * km);
    });
    if (!ranged) return ranged;
    // Equal scales: that of the longer axis.
    const double span = 1.08 * std::max({east.to - east.from, north.to - north.from, 0.1});
    const double east_km = 0.5 * (east.from + east.to), north_km = 0.5 * (north.from + north.to);
    const Chart chart{"touchdown",
                      {84.0, 78.0, 560.0, 560.0},
                      {"east of the target, km", east_km - 0.5 * span, east_km + 0.5 * span},
                      {"north of the target, km", north_km - 0.5 * span, north_km + 0.5 * span}};
    Picture picture{file};
    picture.add(svg_begin(680.0, 700.0, "Touchdown",
                          fmt::format("{}; 99 % ellipse {:.1f} × {:.1f} km, azimuth {:.0f}°",
                                      whose(summary, summary.miss_m.count), ellipse.major_m * km, ellipse.minor_m * km,
                                      ellipse.azimuth_deg)));
    picture.add(chart.begin());
    if (const auto drawn = results.each_touchdown_m([&](Point at) { picture.add(chart.dot(at.x * km, at.y * km)); });
        !drawn)
        return drawn;
    picture.add(chart.ellipse(ellipse.east_m * km, ellipse.north_m * km, ellipse.major_m * km, ellipse.minor_m * km,
                              ellipse.azimuth_deg));
    picture.add(chart.cross(0.0, 0.0, "target") + chart.end() + svg_end());
    return picture.close();
}

Result<void> plot_parachute(CampaignResults& results, const Summary& summary, const std::filesystem::path& file) {
    Range mach{mach_from, mach_to}, pressure_Pa{pressure_from_Pa, pressure_to_Pa};
    const auto ranged = results.each_parachute([&](Point at) {
        mach.take(at.x);
        pressure_Pa.take(at.y);
    });
    if (!ranged) return ranged;
    mach.widen(0.06);
    pressure_Pa.widen(0.06);
    const Chart chart{"parachute",
                      {84.0, 78.0, 560.0, 440.0},
                      {"Mach number at deployment", mach.from, mach.to},
                      {"dynamic pressure, Pa", pressure_Pa.from, pressure_Pa.to}};
    Picture picture{file};
    picture.add(svg_begin(680.0, 580.0, "Parachute deployment", whose(summary, summary.parachute_mach.count)));
    picture.add(chart.begin());
    picture.add(chart.wanted(mach_from, mach_to, pressure_from_Pa, pressure_to_Pa, "Mach 1.4 … 2.2, 200 … 750 Pa"));
    if (const auto drawn = results.each_parachute([&](Point at) { picture.add(chart.dot(at.x, at.y)); }); !drawn)
        return drawn;
    picture.add(chart.end() + svg_end());
    return picture.close();
}

/// Counts values in bins of equal width; values outside go to the outermost bins.
class Histogram {
  public:
    Histogram(double from, double to) : from_(from), width_((to - from) / static_cast<double>(bins)) {}
    void add(double value) {
        const double bin = std::clamp(std::floor((value - from_) / width_), 0.0, static_cast<double>(bins - 1));
        ++counts_[static_cast<std::size_t>(bin)];
    }
    std::uint64_t most() const { return *std::ranges::max_element(counts_); }
    std::string bars(const Chart& chart) const {
        std::string text;
        for (std::size_t i = 0; i < bins; ++i)
            if (counts_[i] > 0)
                text += chart.bar(from_ + static_cast<double>(i) * width_, from_ + static_cast<double>(i + 1) * width_,
                                  static_cast<double>(counts_[i]));
        return text;
    }

  private:
    static constexpr std::size_t bins = 40;
    double from_, width_;
    std::array<std::uint64_t, bins> counts_{};
};

Result<void> plot_touchdown_speed(CampaignResults& results, const Summary& summary, const std::filesystem::path& file) {
    Range vertical{vertical_from_mps, vertical_to_mps}, horizontal{0.0, horizontal_to_mps};
    const auto ranged = results.each_touchdown_speed_mps([&](Point speed) {
        vertical.take(speed.x);
        horizontal.take(speed.y);
    });
    if (!ranged) return ranged;
    vertical.widen(0.08);
    horizontal.to *= 1.08;
    Histogram down{vertical.from, vertical.to}, across{horizontal.from, horizontal.to};
    const auto counted = results.each_touchdown_speed_mps([&](Point speed) {
        down.add(speed.x);
        across.add(speed.y);
    });
    if (!counted) return counted;
    Picture picture{file};
    picture.add(svg_begin(1000.0, 480.0, "Touchdown speed", whose(summary, summary.vertical_mps.count)));
    const auto draw = [&](const char* id, double left, const char* label, const Range& range, double from, double to,
                          const char* name, const Histogram& histogram) {
        const double top = 1.18 * static_cast<double>(std::max<std::uint64_t>(histogram.most(), 1));
        const Chart chart{id, {left, 78.0, 400.0, 340.0}, {label, range.from, range.to}, {"cases", 0.0, top}};
        picture.add(chart.begin() + chart.wanted(from, to, 0.0, top, name) + histogram.bars(chart) + chart.end());
    };
    draw("vertical", 84.0, "vertical, m/s", vertical, vertical_from_mps, vertical_to_mps, "0.75 ± 0.1 m/s", down);
    draw("horizontal", 574.0, "horizontal, m/s", horizontal, 0.0, horizontal_to_mps, "≤ 0.5 m/s", across);
    picture.add(svg_end());
    return picture.close();
}

}  // namespace

Result<void> write_plots(CampaignResults& results, const Summary& summary, const std::filesystem::path& directory) {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (!std::filesystem::is_directory(directory, error)) return Error{directory.string() + ": is no directory"};
    if (const auto done = plot_touchdown(results, summary, directory / "touchdown.svg"); !done) return done;
    if (const auto done = plot_parachute(results, summary, directory / "parachute.svg"); !done) return done;
    return plot_touchdown_speed(results, summary, directory / "touchdown_speed.svg");
}

}  // namespace aeolis::server::campaign
