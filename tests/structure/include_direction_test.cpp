// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

#include <map>
#include <regex>
#include <set>

namespace structure_include_direction_test {

namespace {

using namespace aeolis::structure;

struct Include {
    std::string file;
    std::size_t line;
    std::string target;  // as written, without the marks
    bool system;
};

const std::vector<std::string>& folders() {
    static const std::vector<std::string> names{"common",   "dictionaries", "flight", "simulation", "telemetry",
                                                "commands", "server",       "tests",  "bench"};
    return names;
}

std::vector<Include> all_includes() {
    static const std::regex pattern{R"(^\s*#\s*include\s*([<"])([^">]+)[">])"};
    std::vector<Include> found;
    for (const std::string& folder : folders()) {
        for (const std::string& file : files_under(folder, {".hpp", ".cpp"})) {
            const auto lines = lines_of(file);
            for (std::size_t i = 0; i < lines.size(); ++i) {
                std::smatch match;
                if (std::regex_search(lines[i], match, pattern)) {
                    found.push_back({file, i + 1, match[2], match[1] == "<"});
                }
            }
        }
    }
    return found;
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& prefixes) {
    return std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& p) { return text.starts_with(p); });
}

std::string top_folder(const std::string& path) {
    return path.substr(0, path.find('/'));
}

std::string where(const Include& include) {
    return include.file + ":" + std::to_string(include.line) + " includes " + include.target;
}

/// What each folder may include of ours, by prefix. The order is that of docs/architecture.md.
const std::map<std::string, std::vector<std::string>>& allowed() {
    static const std::map<std::string, std::vector<std::string>> graph{
        {"common", {"common/"}},
        {"dictionaries", {"common/", "dictionaries/"}},
        {"flight", {"common/", "dictionaries/", "flight/", "generated/"}},
        {"simulation",
         {"common/", "dictionaries/", "flight/devices/", "flight/computer.hpp", "flight/load.hpp", "telemetry/port.hpp",
          "simulation/"}},
        // The rover's radio runs flight's delivery of files.
        {"simulation/devices",
         {"common/", "flight/devices/", "flight/computer.hpp", "flight/load.hpp", "flight/file_delivery/",
          "simulation/"}},
        // A test venue flies parts of the flight software without the rest, so it knows them by name; what stands in
        // place of the timeline follows its rule.
        {"simulation/venues",
         {"common/", "dictionaries/timeline_rule.hpp", "flight/devices/", "flight/gnc/", "flight/load.hpp",
          "generated/", "simulation/"}},
        {"telemetry", {"common/", "dictionaries/", "telemetry/"}},
        {"commands", {"common/", "dictionaries/", "commands/"}},
        {"server",
         {"common/", "dictionaries/", "flight/", "simulation/", "telemetry/", "commands/", "server/", "generated/",
          "aeolis/v1/"}},
        {"tests", {""}},
        {"bench", {""}},
    };
    return graph;
}

/// Where each third party, or part of the standard library, may be named. The first rule whose prefix fits counts.
struct Home {
    std::string header;
    std::vector<std::string> files;
    std::string why;
};

const std::vector<Home>& homes() {
    static const std::vector<std::string> with_effects{"server/", "tests/", "bench/"};
    static const std::vector<Home> rules{
        {"pugixml", {"dictionaries/", "tests/"}, "pugixml is at home in dictionaries/"},
        {"Eigen/",
         {"flight/gnc/", "simulation/", "telemetry/mfsk", "server/reconstruction/", "tests/", "bench/"},
         "Eigen: flight/gnc, simulation, telemetry/mfsk, server/reconstruction"},
        {"google/protobuf/", with_effects, "Protobuf is at home in server/"},
        {"aeolis/v1/", with_effects, "Protobuf is at home in server/"},
        {"sqlite3", {"server/archive/", "tests/", "bench/"}, "SQLite is at home in server/archive/"},
        {"zstd", {"server/archive/", "tests/", "bench/"}, "zstd is at home in server/archive/"},
        {"nats/", {"server/cluster/engine.cpp"}, "NATS is at home in server/cluster/engine.cpp"},
        {"muParser", {"server/archive/expression.cpp"}, "muParser is at home in server/archive/expression.cpp"},
        {"yaml", {"server/procedures/yaml_document.cpp"}, "libyaml is at home in server/procedures/yaml_document.cpp"},
        {"hdf5", {"server/campaign/case_hdf5.cpp", "tests/"}, "HDF5 is at home in server/campaign/case_hdf5.cpp"},
        {"sodium", {"server/access/secrets.cpp"}, "libsodium is at home in server/access/secrets.cpp"},
        {"boost/", with_effects, "Boost is at home in server/"},
        {"openssl/",
         {"server/", "dictionaries/load.cpp", "tests/", "bench/"},
         "OpenSSL is at home in server/, and hashes dictionaries"},
        {"spdlog/", with_effects, "only server/ logs"},
        {"CLI/", with_effects, "only server/ reads a command line"},
        {"catch2/", {"tests/support/"}, "Catch2 is reached through tests/support/catch.hpp"},
        {"chrono",
         {"common/time.cpp", "server/", "tests/", "bench/"},
         "only server/ knows the real clock (common/time.cpp: the calendar)"},
        {"ctime", with_effects, "only server/ knows the real clock"},
        {"thread", with_effects, "only server/ has threads"},
        {"mutex", with_effects, "only server/ has threads"},
        {"atomic", with_effects, "only server/ has threads"},
        {"future", with_effects, "only server/ has threads"},
        {"condition_variable", with_effects, "only server/ has threads"},
        {"sys/socket", with_effects, "only server/ has sockets"},
        {"fstream",
         {"dictionaries/", "server/", "tests/", "bench/"},
         "only server/, and the dictionary's loader, read files"},
        {"filesystem",
         {"dictionaries/", "server/", "tests/", "bench/"},
         "only server/, and the dictionary's loader, read files"},
        {"iostream", {"dictionaries/", "server/", "tests/", "bench/"}, "only programs print"},
    };
    return rules;
}

/// Those that may know the simulator, of what stands above it.
const std::vector<std::string>& simulator_folders() {
    static const std::vector<std::string> names{
        "server/rehearsal/", "server/campaign/", "server/shadow/", "server/cluster/", "server/venue/",
        "server/scenario/",  "server/tones/",    "server/cli/",    "tests/",          "bench/"};
    return names;
}

/// The layers of server/, lowest first, each with those right below it: the table in docs/architecture.md, which has
/// the order of server/CMakeLists.txt. A layer reaches these, what they reach, and nothing else.
const std::vector<std::pair<std::string, std::vector<std::string>>>& layers() {
    static const auto of_the_table = [] {
        static const std::regex row{R"(^\| `(\w+)/` \|([\w, ]*)\| [^|]+\|$)"}, name{R"(\w+)"};
        std::vector<std::pair<std::string, std::vector<std::string>>> order;
        bool inside = false;
        for (const std::string& line : lines_of("docs/architecture.md")) {
            if (line == "| layer | right below it | holds |") inside = true;
            if (line.empty()) inside = false;
            std::smatch columns;
            if (!inside || !std::regex_match(line, columns, row)) continue;
            const std::string below = columns[2];
            order.emplace_back(columns[1], std::vector<std::string>{});
            for (auto found = std::sregex_iterator{below.begin(), below.end(), name}; found != std::sregex_iterator{};
                 ++found)
                order.back().second.push_back(found->str());
        }
        return order;
    }();
    return of_the_table;
}

std::string layer_of(const std::string& file) {
    if (!file.starts_with("server/")) return "";
    const auto end = file.find('/', 7);
    return end == std::string::npos ? "" : file.substr(7, end - 7);
}

/// Each layer with all that it reaches.
std::map<std::string, std::set<std::string>> reach() {
    std::map<std::string, std::set<std::string>> all;
    for (const auto& [layer, below] : layers()) {
        std::set<std::string>& reached = all[layer];
        reached.insert(layer);
        for (const std::string& one : below) reached.insert(all.at(one).begin(), all.at(one).end());
    }
    return all;
}

using ByFile = std::map<std::string, std::vector<const Include*>>;

ByFile by_file(const std::vector<Include>& includes) {
    ByFile of_file;
    for (const Include& include : includes)
        if (!include.system) of_file[include.file].push_back(&include);
    return of_file;
}

/// Chains of includes by which a file of server/ comes to a layer that it may not reach, a line each.
std::string ways_up(const std::vector<Include>& includes) {
    const auto allowed_layers = reach();
    const ByFile of_file = by_file(includes);
    std::string ways;
    for (const auto& [file, direct] : of_file) {
        const std::string layer = layer_of(file);
        if (layer.empty()) continue;
        if (!allowed_layers.contains(layer)) {
            ways += file + ": server/" + layer + " is not among the layers\n";
            continue;
        }
        std::set<std::string> seen{file};
        std::vector<std::pair<std::string, std::string>> open{{file, file}};  // and the way there
        while (!open.empty()) {
            const auto [at, way] = open.back();
            open.pop_back();
            const std::string there = layer_of(at);
            if (!there.empty() && !allowed_layers.at(layer).contains(there)) {
                ways += way + "\n";
                break;
            }
            if (!of_file.contains(at)) continue;
            for (const Include* next : of_file.at(at))
                if (seen.insert(next->target).second) open.emplace_back(next->target, way + " > " + next->target);
        }
    }
    return ways;
}

/// Chains of includes by which ground code reaches the simulator, a line each. What a folder that may know it includes
/// in turn is its own affair.
std::string ways_to_the_simulator(const std::vector<Include>& includes) {
    const ByFile of_file = by_file(includes);
    std::string ways;
    for (const auto& [file, direct] : of_file) {
        if (file.starts_with("simulation/") || starts_with_any(file, simulator_folders())) continue;
        std::set<std::string> seen{file};
        std::vector<std::pair<std::string, std::string>> open{{file, file}};  // and the way there
        while (!open.empty()) {
            const auto [at, way] = open.back();
            open.pop_back();
            if (at.starts_with("simulation/")) {
                ways += way + "\n";
                break;
            }
            if (starts_with_any(at, simulator_folders()) || !of_file.contains(at)) continue;
            for (const Include* next : of_file.at(at))
                if (seen.insert(next->target).second) open.emplace_back(next->target, way + " > " + next->target);
        }
    }
    return ways;
}

}  // namespace

TEST_CASE("ground code reaches no header of the simulator, by whatever it includes", "[structure][invariant8][R53]") {
    auto includes = all_includes();
    CHECK(ways_to_the_simulator(includes) == "");
    for (const Include& include : includes) {
        if (!starts_with_any(include.file, {"telemetry/", "commands/", "server/pipeline/", "server/archive/"}))
            continue;
        INFO(where(include));  // nor a folder that does
        CHECK_FALSE(starts_with_any(include.target, simulator_folders()));
    }
    for (const std::string ground :
         {"telemetry", "commands", "server/pipeline", "server/archive", "server/api", "server/net"})
        for (const std::string& file : files_under(ground, {".hpp", ".cpp"})) {
            INFO(file);
            CHECK(text_of(file).find("simulation::") == std::string::npos);
        }
    // One that is planted is found, also behind another header.
    includes.push_back({"telemetry/port.hpp", 1, "simulation/links/uhf_link.hpp", false});
    const auto ways = ways_to_the_simulator(includes);
    CHECK_THAT(ways, Catch::Contains("telemetry/port.hpp > simulation/links/uhf_link.hpp\n"));
    CHECK_THAT(ways, Catch::Contains("telemetry/station/received.hpp > telemetry/port.hpp > simulation/"));
}

TEST_CASE("a folder of server/ reaches only the layers below it, by whatever it includes", "[structure]") {
    auto includes = all_includes();
    CHECK(ways_up(includes) == "");
    // One that is planted is found, also behind another header.
    includes.push_back({"server/archive/records.hpp", 1, "server/api/query_text.hpp", false});
    CHECK_THAT(ways_up(includes),
               Catch::Contains("server/archive/records.hpp > server/api/query_text.hpp\n") &&
                   Catch::Contains("server/pipeline/annotations.hpp > server/archive/records.hpp > server/api/"));
}

TEST_CASE("a folder includes only what stands before it in the house", "[structure]") {
    std::string broken;
    std::size_t seen = 0;
    for (const Include& include : all_includes()) {
        const std::string target = top_folder(include.target);
        const bool ours = std::find(folders().begin(), folders().end(), target) != folders().end();
        if (!ours && !include.target.starts_with("generated/")) {
            continue;
        }
        ++seen;
        const std::string folder = include.file.substr(0, include.file.rfind('/'));
        if (!starts_with_any(include.target,
                             allowed().at(allowed().contains(folder) ? folder : top_folder(include.file)))) {
            broken += where(include) + "\n";
        }
    }
    CHECK(seen > 20);
    INFO(broken);
    CHECK(broken.empty());
}

TEST_CASE("each third party and each effect has one home", "[structure][R46]") {
    std::string broken;
    for (const Include& include : all_includes()) {
        for (const Home& home : homes()) {
            const bool whole_name = home.header.back() == '/' || include.target == home.header ||
                                    include.target.starts_with(home.header + ".");
            if (include.target.starts_with(home.header) && whole_name) {
                if (!starts_with_any(include.file, home.files)) {
                    broken += where(include) + ": " + home.why + "\n";
                }
                break;
            }
        }
    }
    INFO(broken);
    CHECK(broken.empty());
}

TEST_CASE("headers that name Boost are those of server/net for its own use, so that Beast is compiled in few files",
          "[structure]") {
    std::string broken;
    std::set<std::string> with_boost;
    for (const Include& include : all_includes()) {
        if (!include.target.starts_with("boost/") || !include.file.ends_with(".hpp")) continue;
        with_boost.insert(include.file);
        if (!include.file.starts_with("server/net/")) broken += where(include) + "\n";
    }
    for (const Include& include : all_includes())
        if (with_boost.contains(include.target) && !include.file.starts_with("server/net/"))
            broken += where(include) + "\n";
    // Through no other header of server/net, either.
    for (const Include& include : all_includes())
        if (with_boost.contains(include.target) && include.file.ends_with(".hpp") && !with_boost.contains(include.file))
            broken += where(include) + "\n";
    INFO(broken);
    CHECK(broken.empty());
}

TEST_CASE("flight and simulation use nothing whose order or value changes from run to run", "[structure]") {
    std::string broken;
    for (const Include& include : all_includes()) {
        const bool deterministic = include.file.starts_with("flight/") || include.file.starts_with("simulation/");
        const bool unsteady = include.target == "random" || include.target.starts_with("unordered_");
        if (deterministic && include.system && unsteady) {
            broken += where(include) + "\n";
        }
    }
    INFO(broken);
    CHECK(broken.empty());
}

TEST_CASE(
    "the four modules of EDL, and MFSK beside them, each have their folder, and EdlGnc is a library without mailbox",
    "[structure][R47]") {
    for (const std::string module :
         {"flight/edl/edl_main.hpp", "flight/gnc/edl_gnc.hpp", "flight/edl_comm/edl_comm.hpp",
          "flight/edl_bg/edl_bg.hpp", "flight/mfsk/tone_selector.hpp"}) {
        INFO(module);
        CHECK(!text_of(module).empty());
    }
    std::string broken;
    for (const Include& include : all_includes()) {
        const bool modules_of_others =
            include.target.starts_with("flight/") && include.target != "flight/load.hpp" &&
            !starts_with_any(include.target,
                             {"flight/gnc/", "flight/devices/device_messages", "flight/devices/effectors"});
        if (include.file.starts_with("flight/gnc/") && modules_of_others) {
            broken += where(include) + "\n";
        }
    }
    INFO(broken);
    CHECK(broken.empty());
}

}  // namespace structure_include_direction_test
