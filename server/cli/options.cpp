// SPDX-License-Identifier: Apache-2.0
#include "server/cli/options.hpp"

#include <string>

namespace aeolis::server {
namespace {

constexpr std::size_t decode_skip_max = 65536;  // chosen: the longest frame

}  // namespace

void add_shared(CLI::App& command, SharedOptions& shared) {
    command.add_option("--dictionary", shared.dictionary, "directory of the mission's dictionary")
        ->capture_default_str();
    command.add_option("--scenarios", shared.scenarios, "directory of the shipped scenarios")->capture_default_str();
}

CLI::Validator whole_number() {
    return {[](std::string& text) {
                const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
                return digits && text.size() <= 15 ? std::string{} : "not a whole number of at most 15 digits: " + text;
            },
            "NUMBER"};
}

std::array<CLI::Option*, 3> add_stream_format(CLI::App& command, PacketStreamFormat& format) {
    return {command.add_option("--format", format.name, "packets, tm, aos, cadu or pltu")->capture_default_str(),
            command.add_option("--skip", format.skip, "octets to skip before each packet, TM or AOS frame")
                ->check(whole_number())
                ->check(CLI::Range(std::size_t{0}, decode_skip_max))
                ->capture_default_str(),
            command
                .add_option("--frame-octets", format.frame_octets,
                            "octets of a TM or AOS frame; found by trying if left out")
                ->check(whole_number())
                ->check(CLI::Range(std::size_t{9}, std::size_t{65536}))};
}

void add_archive_file(CLI::App& command, std::filesystem::path& archive) {
    command.add_option("--archive", archive, "the SQLite file that serve or rehearse wrote")->capture_default_str();
}

void add_archive_and_dictionary(CLI::App& command, ArchiveOptions& options) {
    add_archive_file(command, options.archive);
    command.add_option("--dictionary", options.shared.dictionary, "directory of the mission's dictionary")
        ->capture_default_str();
    command.add_option("--xtce", options.xtce, "XTCE file of the followed mission, if the run followed one");
}

}  // namespace aeolis::server
