// SPDX-License-Identifier: Apache-2.0
#include "server/base/version.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/shipped_paths.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace {

using namespace aeolis::server;

constexpr std::uint64_t campaign_cases_max = 10'000'000;  // chosen: a month on many processors
constexpr std::size_t decode_skip_max = 65536;            // chosen: the longest frame
constexpr unsigned campaign_jobs_max = 256;               // chosen: each holds a landing

void add_shared(CLI::App& command, SharedOptions& shared) {
    command.add_option("--dictionary", shared.dictionary, "directory of the mission's dictionary")
        ->capture_default_str();
    command.add_option("--scenarios", shared.scenarios, "directory of the shipped scenarios")->capture_default_str();
}

/// Refuses what CLI11 reads into an unsigned number without complaint, such as -1.
CLI::Validator whole_number() {
    return {[](std::string& text) {
                const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
                return digits && text.size() <= 15 ? std::string{} : "not a whole number of at most 15 digits: " + text;
            },
            "NUMBER"};
}

/// @return the options, of which any may need another
std::array<CLI::Option*, 3> add_stream_format(CLI::App& command, DownlinkForm& format) {
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

/// Names the environment variable of each option: AEOLIS_LOG_LEVEL for --log-level. Not of --config, which is read
/// before.
void name_environment(CLI::App& command) {
    for (auto* option : command.get_options()) {
        const auto& name = option->get_lnames().front();
        if (name == "help" || name == "config") continue;
        std::string variable = "AEOLIS_" + name;
        for (char& c : variable) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        option->envname(variable);
    }
}

std::optional<std::filesystem::path> settings_given(int argc, char** argv) {
    constexpr std::string_view option = "--config";
    for (int i = 2; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == option && i + 1 < argc) return argv[i + 1];
        if (word.starts_with(option) && word.substr(option.size()).starts_with('='))
            return word.substr(option.size() + 1);
    }
    return std::nullopt;
}

/// Makes the file's values the defaults of the options, so that environment and command line take precedence.
aeolis::Result<void> take_settings(CLI::App& command, const std::filesystem::path& file) {
    std::ifstream in{file};
    if (!in) return aeolis::Error{file.string() + " cannot be read"};
    CLI::ConfigINI reader;
    reader.arrayBounds(
        '\x01',
        '\x01');  // else it splits values at commas and blanks, which options with several values do themselves
    for (const auto& item : reader.from_config(in)) {
        auto* option = item.name == "config" ? nullptr : command.get_option_no_throw("--" + item.name);
        if (option == nullptr || item.inputs.size() != 1)
            return aeolis::Error{fmt::format("{}: '{}' is no option of aeolis {} with one value", file.string(),
                                             item.fullname(), command.get_name())};
        try {
            option->run_callback_for_default()->default_val(item.inputs.front());
        } catch (const CLI::Error& error) {
            return aeolis::Error{file.string() + ": " + error.what()};
        }
    }
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    spdlog::set_default_logger(spdlog::stderr_color_mt("aeolis"));
    spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");

    CLI::App app{"Aeolis lands a spacecraft on Mars and lets you control it from a browser.\n"
                 "Exit codes: 0 done, 1 failed or found something, 2 wrong use, 3 unknown whether it was done (send)."};
    app.name("aeolis");
    app.set_version_flag("--version", version);
    app.require_subcommand(1);
    int exit_code = 0;

    ServeOptions serving;
    serving.shared = {shipped("dictionaries/msl"), shipped("simulation/scenarios")};
    serving.web = shipped("web/dist");
    auto* serve_command = app.add_subcommand("serve", "serves the console: open the address it prints in a browser.\n"
                                                      "Each option can also stand in a file (--config), a line each "
                                                      "without its dashes: archive=/var/lib/aeolis/aeolis.db.\n"
                                                      "The command line takes precedence over the environment "
                                                      "variable named beside an option, and that over the file.");
    std::filesystem::path settings;
    serve_command->add_option("--config", settings, "file of options");
    serve_command
        ->add_option(
            "--listen", serving.listen,
            "ADDRESS:PORT; port 0 takes a free one. An address that other machines reach needs --accounts and TLS")
        ->capture_default_str();
    serve_command->add_option(
        "--accounts", serving.accounts,
        "file of users and tokens, made at the first start; without it nobody logs in, on loopback only");
    serve_command->add_option("--tls-certificate", serving.certificate,
                              "PEM file with the server's certificate and its chain; serves https only");
    serve_command->add_option("--tls-key", serving.key, "PEM file with its private key");
    serve_command
        ->add_option("--host", serving.names,
                     "names by which browsers call this server, separated by commas; loopback names always work")
        ->delimiter(',');
    serve_command->add_option("--archive", serving.archive, "SQLite file that keeps everything")->capture_default_str();
    serve_command->add_option("--web", serving.web, "directory of the built console")->capture_default_str();
    serve_command->add_option("--log-level", serving.log_level, "what is logged to standard error")
        ->check(CLI::IsMember({"debug", "info", "warn", "error"}))
        ->capture_default_str();
    serve_command->add_option("--log-format", serving.log_format, "text for people, or json: an object a line")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
    auto* scenario_option = serve_command->add_option(
        "--scenario", serving.scenario, "rehearsal to start at once: a file, or the name of a shipped one");
    auto* downlink =
        serve_command
            ->add_option("--downlink", serving.downlink,
                         "follow another mission instead of rehearsing: tcp://HOST:PORT connects, and reconnects "
                         "after every end, waiting longer each time up to 30 s; udp://HOST:PORT listens (with "
                         "--format packets each datagram holds whole packets). What arrives is a run of its own: "
                         "its packets, and their numbers as channels, are in stream, archive and API")
            ->excludes(scenario_option);
    auto* xtce = serve_command
                     ->add_option("--xtce", serving.xtce,
                                  "that mission's XTCE file; unsupported parts are named with their lines")
                     ->needs(downlink);
    downlink->needs(xtce);
    for (auto* option : add_stream_format(*serve_command, serving.format)) option->needs(downlink);
    serve_command->add_option("--seed", serving.seed, "seed of that rehearsal's errors")
        ->check(whole_number())
        ->capture_default_str();
    serve_command->add_option("--pace", serving.pace, "pace of that rehearsal: 1 … 1000, or 0 for as fast as it goes")
        ->check(CLI::Validator{[](std::string& text) {
                                   const double pace = std::strtod(text.c_str(), nullptr);
                                   return pace == 0.0 || (pace >= 1.0 && pace <= 1000.0)
                                              ? std::string{}
                                              : "neither 0 nor within 1 … 1000: " + text;
                               },
                               "PACE"})
        ->capture_default_str();
    add_shared(*serve_command, serving.shared);
    name_environment(*serve_command);
    serve_command->callback([&] { exit_code = serve(serving); });

    RehearseOptions rehearsing;
    rehearsing.shared = serving.shared;
    auto* rehearse_command = app.add_subcommand("rehearse", "flies one landing without a console, as fast as it goes");
    rehearse_command->add_option("--scenario", rehearsing.scenario, "a file, or the name of a shipped one")->required();
    rehearse_command->add_option("--seed", rehearsing.seed, "seed of the errors")
        ->check(whole_number())
        ->capture_default_str();
    rehearse_command
        ->add_option("--case", rehearsing.case_number, "number of another draw of the errors under the same seed")
        ->check(whole_number())
        ->capture_default_str();
    rehearse_command->add_option("--archive", rehearsing.archive, "store everything in this SQLite file");
    rehearse_command->add_option("--truth", rehearsing.truth,
                                 "write the true path, 16 rows a second, to this CSV file");
    rehearse_command->add_flag("--json", rehearsing.json, "print one JSON object");
    add_shared(*rehearse_command, rehearsing.shared);
    rehearse_command->callback([&] { exit_code = rehearse(rehearsing); });

    EntryReferenceOptions referring;
    referring.shared = serving.shared;
    auto* entry_command = app.add_subcommand("entry", "entry guidance")->require_subcommand(1);
    auto* reference = entry_command->add_subcommand(
        "reference", "prints the tables that entry guidance follows, flown from the scenario (CSV)");
    reference->add_option("--scenario", referring.scenario, "a file, or the name of a shipped one")->required();
    add_shared(*reference, referring.shared);
    reference->callback([&] { exit_code = entry_reference(referring); });
    CampaignOptions dispersing;
    dispersing.shared = serving.shared;
    auto* campaign_command = app.add_subcommand(
        "campaign",
        "flies dispersed landings and prints statistics; continues where an earlier call ended; exit code 1 when a "
        "case did not end in touchdown");
    campaign_command->add_option("--scenario", dispersing.scenario, "a file, or the name of a shipped one")->required();
    campaign_command->add_option("--cases", dispersing.cases, "cases 1 … N, each as rehearse --case flies it")
        ->required()
        ->check(whole_number())
        ->check(CLI::Range(std::uint64_t{1}, campaign_cases_max));
    campaign_command->add_option("--seed", dispersing.seed, "seed of the errors")
        ->check(whole_number())
        ->capture_default_str();
    campaign_command->add_option("--jobs", dispersing.jobs, "cases at a time; one a processor if left out")
        ->check(whole_number())
        ->check(CLI::Range(1U, campaign_jobs_max));
    campaign_command->add_option("--results", dispersing.results,
                                 "SQLite file of the cases; run-data/campaign-SCENARIO-SEED.db if left out");
    campaign_command->add_option("--plots", dispersing.plots, "write pictures (SVG) into this directory");
    campaign_command->add_flag("--json", dispersing.json, "print one JSON object");
    add_shared(*campaign_command, dispersing.shared);
    campaign_command->callback([&] { exit_code = run_campaign(dispersing); });

    ModulesOptions counting;
    counting.shared = serving.shared;
    auto* modules_command = app.add_subcommand(
        "modules", "prints the flight software's modules, messages, rates and priorities as Markdown");
    modules_command->add_option("--scenario", counting.scenario, "scenario whose landing is counted")
        ->capture_default_str();
    modules_command->add_option("--seed", counting.seed, "seed of the errors")
        ->check(whole_number())
        ->capture_default_str();
    add_shared(*modules_command, counting.shared);
    modules_command->callback([&] { exit_code = modules(counting); });

    DecodeOptions decoding;
    auto* decode_command = app.add_subcommand(
        "decode", "decodes any mission's packets by its XTCE file; exit code 1 when an octet could not be decoded");
    decode_command->add_option("--xtce", decoding.xtce, "the mission's XTCE file, version 1.0 to 1.3")->required();
    decode_command->add_option("--packets", decoding.packets, "file of packets or frames")->required();
    add_stream_format(*decode_command, decoding.format);
    auto* leap_seconds = decode_command->add_option(
        "--lsk", decoding.leap_seconds, "leap seconds (SPICE text kernel): turns packets' GPS or TAI time into UTC");
    auto* clock_kernel =
        decode_command
            ->add_option("--sclk", decoding.clock_kernel,
                         "the spacecraft's clock (SPICE text kernel, type 1): turns packets' time into SCET, "
                         "UTC as 2012-219T05:17:57.123")
            ->needs(leap_seconds);
    decode_command
        ->add_option("--partition", decoding.partition,
                     "partition of the clock; the first that holds the count if left out")
        ->check(whole_number())
        ->needs(clock_kernel);
    decode_command->add_flag(
        "--csv", decoding.csv,
        "print a row a packet: index, APID, count, time, then NAME=RAW|CALIBRATED each. Time is the first "
        "absolute time in the packet, seconds since its epoch (UNIX: as UTC). Where the XTCE file "
        "has none, it is the two numbers behind the primary header if their names contain 'coarse' "
        "and 'fine': counts and their binary fraction (CUC). Otherwise it is empty");
    decode_command->callback([&] { exit_code = decode(decoding); });

    auto* dictionary_command =
        app.add_subcommand("dictionary", "checks and exports a mission's dictionary")->require_subcommand(1);
    auto checked = serving.shared.dictionary;
    auto* check =
        dictionary_command->add_subcommand("check", "checks every rule, and names each error with file and line");
    check->add_option("DIR", checked, "the dictionary's directory, or a file that export wrote")->capture_default_str();
    check->callback([&] { exit_code = dictionary_check(checked); });
    auto* diagram = dictionary_command->add_subcommand("diagram", "prints the state machines as diagrams (Mermaid)");
    diagram->add_option("DIR", checked, "the dictionary's directory")->capture_default_str();
    diagram->callback([&] { exit_code = dictionary_diagram(checked); });
    std::filesystem::path export_to;
    auto* exported = dictionary_command->add_subcommand(
        "export",
        "writes the whole dictionary as one XTCE 1.2 file, the spreadsheets as ancillary data; it can be given "
        "wherever a dictionary's directory can");
    exported->add_option("DIR", checked, "the dictionary's directory, or such a file")->capture_default_str();
    exported->add_option("--out", export_to, "file to write; standard output if left out");
    exported->callback([&] { exit_code = dictionary_export(checked, export_to); });

    auto* timeline_command =
        app.add_subcommand("timeline", "proves the timeline's constraints, and compares two versions")
            ->require_subcommand(1);
    TimelineAnalyseOptions analysing{serving.shared.dictionary, false};
    auto* analyse = timeline_command->add_subcommand(
        "analyse", "proves or refutes each row of constraints.csv; exit code 1 when one is not proven");
    analyse->add_option("DIR", analysing.directory, "the dictionary's directory")->capture_default_str();
    analyse->add_flag("--json", analysing.json, "print one JSON object");
    analyse->callback([&] { exit_code = timeline_analyse(analysing); });
    TimelineDiffOptions comparing;
    auto* diff = timeline_command->add_subcommand(
        "diff",
        "prints rows added, removed, moved or changed between two dictionaries; exit code 1 when there are any");
    diff->add_option("DIR_A", comparing.before, "the earlier dictionary's directory")->required();
    diff->add_option("DIR_B", comparing.after, "the later one's")->required();
    diff->add_flag("--json", comparing.json, "print one JSON object");
    diff->callback([&] { exit_code = timeline_diff(comparing); });

    auto* tones_command =
        app.add_subcommand("tones", "decodes and simulates X-band tones in samples")->require_subcommand(1);
    TonesDecodeOptions listening;
    listening.shared = serving.shared;
    auto* heard =
        tones_command->add_subcommand("decode", "prints the tones in a file of complex samples, a line a symbol");
    heard->add_option("--samples", listening.samples, "the file: in-phase and quadrature, little-endian")->required();
    heard->add_option("--rate", listening.rate_hz, "samples a second")->required();
    heard->add_option("--format", listening.format, "cf32 or ci16")->required();
    heard->add_option("--predict", listening.predict, "CSV of the Doppler that was removed: time, doppler_hz");
    heard->add_option("--start", listening.start_s, "time of the first sample [s]")->capture_default_str();
    heard->add_flag("--json", listening.json, "a JSON object a line");
    add_shared(*heard, listening.shared);
    heard->callback([&] { exit_code = tones_decode(listening); });
    TonesSimulateOptions sending;
    sending.shared = serving.shared;
    auto* simulate =
        tones_command->add_subcommand("simulate", "writes a file of samples, from lists or from a landing");
    simulate->add_option("--out", sending.out, "file to write")->required();
    simulate->add_option("--rate", sending.rate_hz, "samples a second")->capture_default_str();
    simulate->add_option("--format", sending.format, "cf32 or ci16")->capture_default_str();
    simulate->add_option("--tones", sending.tones, "CSV: start_s,tone");
    simulate->add_option("--doppler", sending.doppler, "CSV of the Doppler: time, doppler_hz");
    auto* flown = simulate->add_option("--scenario", sending.scenario, "tones and Doppler of this landing instead");
    simulate->get_option("--tones")->excludes(flown);
    simulate->get_option("--doppler")->excludes(flown);
    simulate->add_option("--predict", sending.predict, "CSV of the Doppler to remove: time, doppler_hz");
    simulate
        ->add_option("--predict-out", sending.predict_out, "compute the ground's predict, remove it, and write it here")
        ->excludes(simulate->get_option("--predict"));
    simulate->add_option("--from", sending.from_s, "time of the first sample [s]");
    simulate->add_option("--length", sending.length_s, "length [s]");
    simulate->add_option("--c-n0", sending.c_n0_dbhz, "total power to noise density [dB-Hz]")->capture_default_str();
    simulate->add_option("--seed", sending.seed, "seed of the noise and of the landing")
        ->check(whole_number())
        ->capture_default_str();
    simulate->add_option("--case", sending.case_number, "number of the draw of the landing's errors")
        ->check(whole_number())
        ->capture_default_str();
    add_shared(*simulate, sending.shared);
    simulate->callback([&] { exit_code = tones_simulate(sending); });
    TonesBenchOptions measuring;
    measuring.shared = serving.shared;
    auto* measured = tones_command->add_subcommand(
        "bench", "prints the receiver's figures beside theory; exit code 1 when a goal is missed");
    measured->add_flag("--full", measuring.full, "measure also the points that take long");
    add_shared(*measured, measuring.shared);
    measured->callback([&] { exit_code = tones_bench(measuring); });

    ExportOptions exporting;
    exporting.of.shared = serving.shared;
    exporting.of.archive = serving.archive;
    const auto add_archive = [](CLI::App& command, std::filesystem::path& archive) {
        command.add_option("--archive", archive, "the SQLite file that serve or rehearse wrote")->capture_default_str();
    };
    const auto add_archive_words = [&](CLI::App& command, ArchiveOptions& options) {
        add_archive(command, options.archive);
        command.add_option("--dictionary", options.shared.dictionary, "directory of the mission's dictionary")
            ->capture_default_str();
        command.add_option("--xtce", options.xtce, "XTCE file of the followed mission, if the run followed one");
    };
    const auto add_selection = [&](CLI::App& command, ExportOptions& options) {
        add_archive_words(command, options.of);
        command.add_option("--run", options.of.run, "number of the run")->required()->check(whole_number());
        command
            .add_option("--channel,--channels", options.channels,
                        "names or aliases, separated by blanks or commas; all if left out")
            ->delimiter(',');
        command.add_option("--from", options.from_s, "first SCLK [s]");
        command.add_option("--to", options.to_s, "last SCLK [s]");
    };
    auto* export_command =
        app.add_subcommand("export", "prints a run's samples in order of SCLK, live and recorded as one series, a "
                                     "row a sample");
    add_selection(*export_command, exporting);
    auto* lines = export_command->add_option("--format", exporting.format, "csv or jsonl")
                      ->check(CLI::IsMember({"csv", "jsonl"}))
                      ->capture_default_str();
    export_command->add_flag("--csv")->description("as CSV, the default")->excludes(lines);
    export_command->add_option("--align", exporting.align,
                               "print a line an instant and a column a channel, each with its newest value: at the "
                               "times of the named channel, or at multiples of so many seconds");
    export_command->add_option("--out", exporting.out, "new file; standard output if left out");
    export_command->callback([&] { exit_code = export_samples(exporting); });

    SendOptions sending_file;
    auto* send_command = app.add_subcommand(
        "send", "sends a command file to a server, all of its commands or none; prints a line a command; exit code 1 "
                "when nothing was sent, 3 when no answer tells whether it was");
    send_command->add_option("--file", sending_file.file, "JSON, as POST /api/v1/runs/{run}/sequences takes it")
        ->required();
    send_command->add_option("--server", sending_file.server, "http://HOST:PORT or https://HOST:PORT")
        ->envname("AEOLIS_SERVER")
        ->capture_default_str();
    send_command
        ->add_option("--token", sending_file.token,
                     "token of a server with accounts, sent over https or to this machine only; other users can read "
                     "a command line, but not AEOLIS_TOKEN")
        ->envname("AEOLIS_TOKEN");
    send_command->add_option(
        "--authorities", sending_file.authorities,
        "PEM file of the authorities that may have signed the server's certificate; the system's if left out");
    send_command->add_option("--by", sending_file.by,
                             "name of the sender, for a server without accounts, if the file has none");
    send_command->add_option("--run", sending_file.run, "send only if this is the current run")->check(whole_number());
    send_command->add_flag("--dry-run", sending_file.dry_run, "only tell what would happen");
    send_command->callback([&] { exit_code = send(sending_file); });

    ReportOptions reporting{exporting.of};
    auto* report_command =
        app.add_subcommand("report", "prints a run as it was flown: each timepoint and event by plan, tone, UHF and "
                                     "recording, the silences, and the proof");
    add_archive(*report_command, reporting.of.archive);
    report_command->add_option("--dictionary", reporting.of.shared.dictionary, "directory of the mission's dictionary")
        ->capture_default_str();
    report_command->add_option("--run", reporting.of.run, "number of the run")->required()->check(whole_number());
    auto* as_object = report_command->add_flag("--json", reporting.json, "print one JSON object");
    report_command->add_flag("--csv", reporting.csv, "print timepoints and events, a row each")->excludes(as_object);
    report_command->callback([&] { exit_code = report(reporting); });

    AccountsOptions keeping;
    auto* accounts_command =
        app.add_subcommand("accounts", "lists and resets the accounts of a server")->require_subcommand(1);
    auto* listed = accounts_command->add_subcommand("list", "prints users and tokens with their roles");
    listed->add_option("--accounts", keeping.file, "the file")->required()->envname("AEOLIS_ACCOUNTS");
    listed->callback([&] { exit_code = accounts_list(keeping); });
    auto* reset = accounts_command->add_subcommand(
        "reset", "gives a user a new password, or makes a new administrator; a running server takes it over");
    reset->add_option("--accounts", keeping.file, "the file")->required()->envname("AEOLIS_ACCOUNTS");
    reset->add_option("--user", keeping.user, "the name")->required();
    reset->callback([&] { exit_code = accounts_reset(keeping); });

    auto* archive_command = app.add_subcommand("archive", "checks and maintains an archive")->require_subcommand(1);
    ArchiveOptions kept = exporting.of;
    auto* verify = archive_command->add_subcommand(
        "verify", "checks the file's structure, its sequence numbers, and every derived "
                  "row against the packets; a line a fault; exit code 1 when there is one");
    add_archive_words(*verify, kept);
    verify->add_option("--run", kept.run, "only this run")->check(whole_number());
    verify->callback([&] { exit_code = archive_verify(kept); });
    auto* rebuild = archive_command->add_subcommand(
        "rebuild", "derives everything again from the packets, in place of what is there; "
                   "not while another program writes");
    add_archive_words(*rebuild, kept);
    rebuild->add_option("--run", kept.run, "only this run")->check(whole_number());
    rebuild->callback([&] { exit_code = archive_rebuild(kept); });
    ExportOptions tabulating = exporting;
    auto* samples =
        archive_command->add_subcommand("samples", "writes a run's samples as rows of an SQLite file, for plain SQL");
    add_selection(*samples, tabulating);
    samples->add_option("--out", tabulating.out, "new file")->required();
    samples->callback([&] { exit_code = archive_samples(tabulating); });
    PruneOptions pruning;
    pruning.archive = serving.archive;
    auto* prune = archive_command->add_subcommand("prune", "removes runs; without --yes it only names them");
    add_archive(*prune, pruning.archive);
    auto* gone =
        prune->add_option("--run", pruning.runs, "numbers, separated by commas")->delimiter(',')->check(whole_number());
    prune->add_option("--keep", pruning.keep, "number of the newest runs to keep; all others are removed")
        ->check(whole_number())
        ->excludes(gone);
    prune->add_flag("--yes", pruning.yes, "remove them");
    prune->callback([&] { exit_code = archive_prune(pruning); });
    auto* vacuum = archive_command->add_subcommand(
        "vacuum", "returns the space of pruned runs to the disk; needs as much again meanwhile");
    add_archive(*vacuum, pruning.archive);
    vacuum->callback([&] { exit_code = archive_vacuum(pruning.archive); });
    std::filesystem::path backup_to;
    auto* backup = archive_command->add_subcommand(
        "backup", "copies the whole archive, as it is now, into a new file, also while another program writes");
    add_archive(*backup, pruning.archive);
    backup->add_option("--out", backup_to, "new file")->required();
    backup->callback([&] { exit_code = archive_backup(pruning.archive, backup_to); });

    try {
        if (argc > 1 && std::string_view{argv[1]} == "serve")
            if (const auto given = settings_given(argc, argv))
                if (const auto taken = take_settings(*serve_command, *given); !taken)
                    return failed(taken.error().message, 2);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        const auto is_first = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
        const bool is_option = argc > 1 && argv[1][0] == '-';
        if (is_option) return failed(fmt::format("there is no option '{}' (aeolis --help)", argv[1]), 2);
        if (argc > 1 && app.get_subcommands(is_first).empty())
            return failed(fmt::format("there is no command '{}' (aeolis --help)", argv[1]), 2);
        if (argc > 2 && argv[2][0] != '-') {
            const auto* command = app.get_subcommand(argv[1]);
            const auto is_second = [&](const CLI::App* each) { return each->get_name() == argv[2]; };
            if (!command->get_subcommands({}).empty() && command->get_subcommands(is_second).empty())
                return failed(fmt::format("there is no command '{0} {1}' (aeolis {0} --help)", argv[1], argv[2]), 2);
        }
        return failed(fmt::format("{} (aeolis --help)", error.what()), 2);
    } catch (const std::exception& error) {
        return failed(error.what());
    }
    return exit_code;
}
