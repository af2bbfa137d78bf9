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

std::vector<CLI::Option*> add_stream_format(CLI::App& command, PacketStreamFormat& format) {
    const auto yes_or_no = [&](const char* name, std::optional<bool>& answer, const char* text) {
        return command
            .add_option_function<std::string>(
                name, [&answer](const std::string& word) { answer = word == "yes"; }, text)
            ->check(CLI::IsMember({"yes", "no"}));
    };
    const auto number = [&](const char* name, auto& value, const char* text, std::size_t least, std::size_t most) {
        return command.add_option(name, value, text)->check(whole_number())->check(CLI::Range(least, most));
    };
    auto* reed_solomon =
        command
            .add_option_function<std::string>(
                "--reed-solomon",
                [&format](const std::string& word) {
                    format.coded = word != "no";
                    if (word == "223") format.check_symbols = 32;
                    if (word == "239") format.check_symbols = 16;
                },
                "frames are in Reed-Solomon codeblocks of (255,223) or (255,239), and are corrected; no: never. Code, "
                "interleaving and basis are found by trial for cadu")
            ->check(CLI::IsMember({"223", "239", "no"}));
    return {
        command.add_option("--format", format.name, "packets, tm, aos, cadu or pltu")->capture_default_str(),
        number("--skip", format.skip, "octets to skip before each packet, TM or AOS frame", 0, decode_skip_max)
            ->capture_default_str(),
        number("--frame-octets", format.frame_octets,
               "octets of a TM or AOS frame, without marker and check symbols; found by trial if left out", 9, 65536),
        number("--check-symbols", format.check_octets,
               "octets to skip behind each frame, such as the check symbols of a code; found by trial for cadu, else 0",
               0, 256),
        reed_solomon,
        number("--interleave", format.interleave, "code words of a Reed-Solomon codeblock: 1, 2, 3, 4, 5 or 8", 1, 8)
            ->check(CLI::IsMember({1, 2, 3, 4, 5, 8}))
            ->needs(reed_solomon),
        command
            .add_option_function<std::string>(
                "--basis",
                [&format](const std::string& word) {
                    format.basis = word == "dual" ? telemetry::ReedSolomonCode::Basis::dual
                                                  : telemetry::ReedSolomonCode::Basis::conventional;
                },
                "basis of Reed-Solomon symbols, dual or conventional; for tm and aos dual if left out")
            ->check(CLI::IsMember({"dual", "conventional"}))
            ->needs(reed_solomon),
        yes_or_no("--randomised", format.randomised, "whether frames are randomised; found by trial for cadu"),
        yes_or_no("--fecf", format.crc, "whether frames end with a CRC-16; found by trial if left out"),
        command.add_flag("--control-field", format.agreed.control_field,
                         "AOS frames have an operational control field of 4 octets; a TM frame says so itself"),
        command.add_flag("--header-error-control", format.agreed.header_error_control,
                         "the headers of AOS frames have 2 octets of error control"),
        number("--insert-octets", format.agreed.insert_octets, "octets of the insert zone of AOS frames", 0, 255),
        number("--virtual-channel", format.virtual_channel, "frames of this virtual channel only", 0, 63)};
}

CLI::Option* add_mission_xtce(CLI::App& command, MissionXtce& xtce, const std::string& description) {
    auto* files = command.add_option("--xtce", xtce.files, description)->allow_extra_args(false);
    command
        .add_option("--root", xtce.root,
                    "name of the container with which packets begin, if several in the XTCE files have no base")
        ->needs(files);
    command
        .add_option("--leading-size", xtce.leading_size,
                    "unit of a text's LeadingSize, which XTCE files do not say: bits or octets")
        ->check(CLI::IsMember({"bits", "octets"}))
        ->capture_default_str()
        ->needs(files);
    command
        .add_option("--time", xtce.time,
                    "the parameter that holds a packet's time, if the XTCE files do not say; its form may follow: "
                    ":seconds, :milliseconds, :microseconds, :cuc, :cuc-preamble, :cds or :cds-preamble")
        ->needs(files);
    return files;
}

CLI::Option* add_engine(CLI::App& command, cluster::EngineAddress& address, const std::string& description) {
    auto& url = *command.add_option("--nats", address.url, description)->envname("AEOLIS_NATS");
    for (auto* option : add_engine_credentials(command, address)) option->needs(&url);
    return &url;
}

std::vector<CLI::Option*> add_engine_credentials(CLI::App& command, cluster::EngineAddress& address) {
    const auto file = [&](const char* option, std::filesystem::path& path, const char* words) {
        return command.add_option(option, path, words)->check(CLI::ExistingFile);
    };
    auto* credentials =
        file("--nats-credentials", address.credentials, "a .creds file, for an engine that knows users by JWT");
    auto* nkey = command.add_option("--nats-nkey", address.nkey, "a public nkey, with --nats-nkey-seed");
    auto* seed = file("--nats-nkey-seed", address.nkey_seed, "the file of its seed")->needs(nkey);
    nkey->needs(seed);
    auto* ca = file("--nats-ca", address.ca, "certificates that sign the engine's; the system's if left out");
    auto* key = file("--nats-key", address.key, "the key of --nats-certificate");
    auto* certificate = file("--nats-certificate", address.certificate, "this client's certificate")->needs(key);
    key->needs(certificate);
    return {credentials, nkey, seed, ca, key, certificate};
}

void add_archive_file(CLI::App& command, std::filesystem::path& archive) {
    command.add_option("--archive", archive, "the SQLite file that serve or rehearse wrote")->capture_default_str();
}

void add_archive_and_dictionary(CLI::App& command, ArchiveOptions& options) {
    add_archive_file(command, options.archive);
    command.add_option("--dictionary", options.shared.dictionary, "directory of the mission's dictionary")
        ->capture_default_str();
    add_mission_xtce(command, options.xtce,
                     "XTCE file of the followed mission, if the run followed one; may be given several times");
}

}  // namespace aeolis::server
