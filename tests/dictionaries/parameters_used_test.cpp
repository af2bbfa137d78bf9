// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <array>
#include <regex>
#include <set>

namespace dictionaries_parameters_used_test {

// One source for parameters: what parameters.csv names, flight uses, and what flight is tuned by stands nowhere else.
namespace {

using namespace aeolis;

const std::vector<std::string>& flight_sources() {
    static const std::vector<std::string> files = structure::files_under("flight", {".hpp", ".cpp"});
    return files;
}

/// Without what stands behind //.
std::string code_of(const std::string& line) {
    return line.substr(0, line.find("//"));
}

}  // namespace

TEST_CASE("each parameter of parameters.csv is used in flight", "[dictionary][R48]") {
    // Members are named behind a dot: parameters.name.
    static const std::regex member{R"(\.([A-Za-z_][A-Za-z0-9_]*))"};
    std::set<std::string> used;
    for (const std::string& file : flight_sources())
        for (const std::string& line : structure::lines_of(file)) {
            const std::string code = code_of(line);
            for (std::sregex_iterator match{code.begin(), code.end(), member}, end; match != end; ++match)
                used.insert((*match)[1]);
        }
    const auto& parameters = tests::shipped_dictionary().parameters;
    CHECK(parameters.size() > 60);
    std::string unused;
    for (const auto& parameter : parameters)
        if (!used.contains(parameter.name)) unused += parameter.name + "\n";
    INFO("parameters that nothing in flight uses: use or remove them\n" << unused);
    CHECK(unused.empty());
    CHECK_FALSE(used.contains("a_parameter_that_is_not_there"));
}

TEST_CASE("no module of EDL or of a device has a constant of its own that tunes it: they come from parameters.csv",
          "[dictionary][R48]") {
    // constexpr TYPE NAME = a number. What remains are units, the world, the interface to a device, memory, and the
    // zero of a computation. Most numbers without a name are refused by clang-tidy (flight/.clang-tidy); the next test
    // reads those that it leaves out.
    static const std::regex literal{R"(constexpr\s+[A-Za-z_:0-9]+\s+([A-Za-z_0-9]+)\s*=\s*-?[0-9])"};
    static const std::set<std::string> no_tuning{
        "pi",
        "degrees_per_radian",
        "parts_in_percent",
        "standard_gravity_mps2",
        "mars_j2",
        "mars_gm_m3ps2",
        "mars_spin_rps",
        "mars_equator_radius_m",
        "imu_period_s",
        "radar_bins_per_second",
        "mars_weight_mps2",
        "reports_per_cycle_max",
        "kept_max",
        "heat_ratio",
        "local_gravity_ends_m",
        "remembered_hz",
        "no_rotation",
        "no_thrust_mps2",
        "determinant_min",
        "past_max",
        "staged_changes_max",
        // Of devices: how many there are, what they are, the rates and sizes of their interface.
        "device_count",
        "redundant_device_count",
        "radar_beam_count",
        "pyro_count",
        "switch_count",
        "thruster_count",
        "engine_count",
        "thruster_force_N",
        "thruster_least_on_s",
        "radius_m",
        "samples_per_second",
        "microseconds_per_second",
        "retry_s",
        "report_period_s",
        "norm_tolerance",
        "state_octets_max",
        "nvm_octets_per_cycle",
    };
    std::string tuning;
    std::size_t seen = 0;
    for (const std::string& file : flight_sources()) {
        const bool of_edl =
            std::ranges::any_of(std::array{"flight/devices/", "flight/gnc/", "flight/edl/", "flight/edl_bg/",
                                           "flight/mfsk/", "flight/fault_protection/"},
                                [&](const char* folder) { return file.starts_with(folder); });
        const auto lines = of_edl ? structure::lines_of(file) : std::vector<std::string>{};
        for (std::size_t i = 0; i < lines.size(); ++i) {
            std::smatch match;
            const std::string code = code_of(lines[i]);
            if (!std::regex_search(code, match, literal)) continue;
            ++seen;
            if (!no_tuning.contains(match[1])) tuning += file + ":" + std::to_string(i + 1) + ": " + code + "\n";
        }
    }
    CHECK(seen >= 9);
    INFO("put the value in parameters.csv and take it from flight::Parameters\n" << tuning);
    CHECK(tuning.empty());
}

TEST_CASE("no formula of GNC has a number of its own that tunes it", "[dictionary][R48]") {
    // Decimal numbers that formulas of physics and geometry have anyway, and guards against a division by nought.
    static const std::set<std::string> of_mathematics{"0.0", "0.5", "1.0", "2.0", "1.0e-3", "1.0e-9", "0.0625"};
    // The gravity and air of Mars, a polynomial's coefficients, a rotation's series, and what ground's solution holds
    // before there is one.
    static const std::set<std::string> files_of_others{"flight/gnc/mars.cpp", "flight/gnc/powered_descent/divert.cpp",
                                                       "flight/gnc/navigation/strapdown.cpp", "flight/gnc/edl_gnc.hpp"};
    static const std::regex decimal{R"((^|[^A-Za-z_0-9.])([0-9]+\.[0-9]+(e[-+]?[0-9]+)?))"};
    std::string tuning;
    std::size_t seen = 0;
    for (const std::string& file : flight_sources()) {
        if (!file.starts_with("flight/gnc/") || files_of_others.contains(file)) continue;
        const auto lines = structure::lines_of(file);
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const std::string code = code_of(lines[i]);
            if (code.find("constexpr") != std::string::npos) continue;  // of the test before
            for (std::sregex_iterator number{code.begin(), code.end(), decimal}, end; number != end; ++number, ++seen)
                if (!of_mathematics.contains((*number)[2]))
                    tuning += file + ":" + std::to_string(i + 1) + ": " + code + "\n";
        }
    }
    CHECK(seen > 100);
    INFO("put the value in parameters.csv and take it from flight::Parameters\n" << tuning);
    CHECK(tuning.empty());
}

}  // namespace dictionaries_parameters_used_test
