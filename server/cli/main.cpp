// SPDX-License-Identifier: Apache-2.0
#include "server/cli/commands.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/version.hpp"

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

constexpr std::uint64_t campaign_cases_max = 10'000'000;  // ours: a month on many processors
constexpr std::size_t decode_skip_max = 65536;            // ours
constexpr unsigned campaign_jobs_max = 256;               // ours: each holds a landing

void add_shared(CLI::App& command, SharedOptions& shared) {
    command.add_option("--dictionary", shared.dictionary, "the mission's words")->capture_default_str();
    command.add_option("--scenarios", shared.scenarios, "directory of the scenarios that ship")->capture_default_str();
}

/// CLI11 reads -1 into an unsigned number without a word.
CLI::Validator whole_number() {
    return {[](std::string& text) {
                const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
                return digits && text.size() <= 15 ? std::string{} : "not a whole number of at most 15 digits: " + text;
            },
            "NUMBER"};
}

/// @return the options, of which any may need another
std::array<CLI::Option*, 3> add_stream_format(CLI::App& command, DownlinkForm& format) {
    return {
        command.add_option("--format", format.name, "packets, tm, aos, cadu or pltu")->capture_default_str(),
        command.add_option("--skip", format.skip, "octets without meaning before each packet, TM or AOS frame")
            ->check(whole_number())
            ->check(CLI::Range(std::size_t{0}, decode_skip_max))
            ->capture_default_str(),
        command.add_option("--frame-octets", format.frame_octets, "of a TM or AOS frame; left out: found by trying")
            ->check(whole_number())
            ->check(CLI::Range(std::size_t{9}, std::size_t{65536}))};
}

/// Each option also stands in an environment variable of its name: --log-level in AEOLIS_LOG_LEVEL. Not --config, which
/// is read before.
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

/// What the file says becomes the default of each option, so that environment and command line count before it.
aeolis::Result<void> take_settings(CLI::App& command, const std::filesystem::path& file) {
    std::ifstream in{file};
    if (!in) return aeolis::Error{file.string() + " cannot be read"};
    CLI::ConfigINI reader;
    reader.arrayBounds(
        '\x01',
        '\x01');  // else it splits a value at commas and blanks: whoever reads the option does, where it has several
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
                 "Exit codes: 0 done, 1 failed or found something, 2 bad use, 3 not known whether it was done (send)."};
    app.name("aeolis");
    app.set_version_flag("--version", version);
    app.require_subcommand(1);
    int exit_code = 0;

    ServeOptions serving;
    serving.shared = {shipped("dictionaries/msl"), shipped("simulation/scenarios")};
    serving.web = shipped("web/dist");
    auto* serve_command = app.add_subcommand("serve", "the console backend: open the address it prints in a browser.\n"
                                                      "Each option can also stand in a file (--config), a line each "
                                                      "without its dashes: archive=/var/lib/aeolis/aeolis.db.\n"
                                                      "What the command line says counts first, then the environment "
                                                      "variable named beside an option, then the file.");
    std::filesystem::path settings;
    serve_command->add_option("--config", settings, "the file of options");
    serve_command
        ->add_option(
            "--listen", serving.listen,
            "ADDRESS:PORT; port 0 takes a free one. An address that other machines reach needs --accounts and TLS")
        ->capture_default_str();
    serve_command->add_option(
        "--accounts", serving.accounts,
        "the file of users and tokens, made at the first start; left out: no log-in, on loopback only");
    serve_command->add_option("--tls-certificate", serving.certificate,
                              "PEM file with the server's certificate and its chain: then https only");
    serve_command->add_option("--tls-key", serving.key, "PEM file with its private key");
    serve_command
        ->add_option("--host", serving.names,
                     "names by which browsers call this server, with commas between; loopback names always count")
        ->delimiter(',');
    serve_command->add_option("--archive", serving.archive, "the SQLite file that keeps everything")
        ->capture_default_str();
    serve_command->add_option("--web", serving.web, "directory of the built console")->capture_default_str();
    serve_command->add_option("--log-level", serving.log_level, "what goes to standard error")
        ->check(CLI::IsMember({"debug", "info", "warn", "error"}))
        ->capture_default_str();
    serve_command->add_option("--log-format", serving.log_format, "text for people, json: an object a line")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
    auto* scenario_option = serve_command->add_option("--scenario", serving.scenario,
                                                      "start this rehearsal at once: a file, or a name that ships");
    auto* downlink =
        serve_command
            ->add_option("--downlink", serving.downlink,
                         "follow another mission instead of rehearsing: tcp://HOST:PORT connects, and again "
                         "after every end, waiting longer each time up to 30 s; udp://HOST:PORT listens (with "
                         "--format packets each datagram holds whole packets). What comes is a run of its own: "
                         "its packets and their numbers, as channels, are in stream, archive and API")
            ->excludes(scenario_option);
    auto* xtce = serve_command
                     ->add_option("--xtce", serving.xtce,
                                  "that mission's XTCE file; what in it is not supported is named with its line")
                     ->needs(downlink);
    downlink->needs(xtce);
    for (auto* option : add_stream_format(*serve_command, serving.format)) option->needs(downlink);
    serve_command->add_option("--seed", serving.seed, "of that rehearsal's errors")
        ->check(whole_number())
        ->capture_default_str();
    serve_command->add_option("--pace", serving.pace, "of that rehearsal: 1 … 1000, 0 as fast as it goes")
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
    auto* rehearse_command = app.add_subcommand("rehearse", "one landing, without a console, as fast as it goes");
    rehearse_command->add_option("--scenario", rehearsing.scenario, "a file, or the name of one that ships")
        ->required();
    rehearse_command->add_option("--seed", rehearsing.seed, "of the errors")
        ->check(whole_number())
        ->capture_default_str();
    rehearse_command->add_option("--case", rehearsing.case_number, "another draw of the errors under the same seed")
        ->check(whole_number())
        ->capture_default_str();
    rehearse_command->add_option("--archive", rehearsing.archive, "store everything in this SQLite file");
    rehearse_command->add_option("--truth", rehearsing.truth,
                                 "write what really flew, 16 rows a second, to this CSV file");
    rehearse_command->add_flag("--json", rehearsing.json, "print one JSON object");
    add_shared(*rehearse_command, rehearsing.shared);
    rehearse_command->callback([&] { exit_code = rehearse(rehearsing); });

    EntryReferenceOptions referring;
    referring.shared = serving.shared;
    auto* entry_command = app.add_subcommand("entry", "entry guidance")->require_subcommand(1);
    auto* reference = entry_command->add_subcommand(
        "reference", "the tables that entry guidance follows, flown from the scenario (CSV)");
    reference->add_option("--scenario", referring.scenario, "a file, or the name of one that ships")->required();
    add_shared(*reference, referring.shared);
    reference->callback([&] { exit_code = entry_reference(referring); });
    CampaignOptions dispersing;
    dispersing.shared = serving.shared;
    auto* campaign_command = app.add_subcommand(
        "campaign", "dispersed landings and what they come to; goes on where an earlier call ended; 1 when a case did "
                    "not end in touchdown");
    campaign_command->add_option("--scenario", dispersing.scenario, "a file, or the name of one that ships")
        ->required();
    campaign_command->add_option("--cases", dispersing.cases, "cases 1 … N, each what rehearse --case flies")
        ->required()
        ->check(whole_number())
        ->check(CLI::Range(std::uint64_t{1}, campaign_cases_max));
    campaign_command->add_option("--seed", dispersing.seed, "of the errors")
        ->check(whole_number())
        ->capture_default_str();
    campaign_command->add_option("--jobs", dispersing.jobs, "cases at a time; left out: one a processor")
        ->check(whole_number())
        ->check(CLI::Range(1U, campaign_jobs_max));
    campaign_command->add_option("--results", dispersing.results,
                                 "the SQLite file of the cases; left out: run-data/campaign-SCENARIO-SEED.db");
    campaign_command->add_option("--plots", dispersing.plots, "write pictures (SVG) into this directory");
    campaign_command->add_flag("--json", dispersing.json, "print one JSON object");
    add_shared(*campaign_command, dispersing.shared);
    campaign_command->callback([&] { exit_code = run_campaign(dispersing); });

    ModulesOptions counting;
    counting.shared = serving.shared;
    auto* modules_command = app.add_subcommand(
        "modules", "the flight software's modules, messages, rates and priorities, as a document (Markdown)");
    modules_command->add_option("--scenario", counting.scenario, "whose landing is counted")->capture_default_str();
    modules_command->add_option("--seed", counting.seed, "of the errors")->check(whole_number())->capture_default_str();
    add_shared(*modules_command, counting.shared);
    modules_command->callback([&] { exit_code = modules(counting); });

    DecodeOptions decoding;
    auto* decode_command =
        app.add_subcommand("decode", "any mission's packets by its XTCE file; 1 when not every octet could be decoded");
    decode_command->add_option("--xtce", decoding.xtce, "the mission's XTCE file, 1.0 to 1.3")->required();
    decode_command->add_option("--packets", decoding.packets, "the file of packets or frames")->required();
    add_stream_format(*decode_command, decoding.format);
    auto* leap_seconds = decode_command->add_option(
        "--lsk", decoding.leap_seconds, "leap seconds, a SPICE text kernel: packets' time in GPS or TAI becomes UTC");
    auto* clock_kernel =
        decode_command
            ->add_option("--sclk", decoding.clock_kernel,
                         "the spacecraft's clock, a SPICE text kernel of type 1: packets' time becomes SCET, "
                         "UTC as 2012-219T05:17:57.123")
            ->needs(leap_seconds);
    decode_command
        ->add_option("--partition", decoding.partition, "of the clock; left out: the first that holds the count")
        ->check(whole_number())
        ->needs(clock_kernel);
    decode_command->add_flag(
        "--csv", decoding.csv,
        "a row a packet: index, APID, count, time, then NAME=RAW|CALIBRATED each. Time is the first "
        "absolute time in the packet, seconds since its epoch (UNIX: as UTC); where the XTCE file "
        "has none, the two numbers right behind the primary header when their names hold 'coarse' "
        "and 'fine': counts and their binary fraction (CUC). Else it is empty");
    decode_command->callback([&] { exit_code = decode(decoding); });

    auto* dictionary_command = app.add_subcommand("dictionary", "the mission's words")->require_subcommand(1);
    auto checked = serving.shared.dictionary;
    auto* check = dictionary_command->add_subcommand("check", "every rule, every error with file and line");
    check->add_option("DIR", checked, "the dictionary's directory, or what export wrote")->capture_default_str();
    check->callback([&] { exit_code = dictionary_check(checked); });
    auto* diagram = dictionary_command->add_subcommand("diagram", "the state machines as diagrams (Mermaid)");
    diagram->add_option("DIR", checked, "the dictionary's directory")->capture_default_str();
    diagram->callback([&] { exit_code = dictionary_diagram(checked); });
    std::filesystem::path export_to;
    auto* exported = dictionary_command->add_subcommand(
        "export",
        "the whole dictionary as one XTCE 1.2 file: packets and commands, and the spreadsheets as ancillary data; "
        "it can be given wherever a dictionary's directory can");
    exported->add_option("DIR", checked, "the dictionary's directory, or such a file")->capture_default_str();
    exported->add_option("--out", export_to, "the file to write; left out: standard output");
    exported->callback([&] { exit_code = dictionary_export(checked, export_to); });

    auto* timeline_command =
        app.add_subcommand("timeline", "constraints proven or refuted; two versions compared")->require_subcommand(1);
    TimelineAnalyseOptions analysing{serving.shared.dictionary, false};
    auto* analyse = timeline_command->add_subcommand(
        "analyse", "proves or refutes each row of constraints.csv; 1 when one is not proven");
    analyse->add_option("DIR", analysing.directory, "the dictionary's directory")->capture_default_str();
    analyse->add_flag("--json", analysing.json, "print one JSON object");
    analyse->callback([&] { exit_code = timeline_analyse(analysing); });
    TimelineDiffOptions comparing;
    auto* diff = timeline_command->add_subcommand(
        "diff", "rows added, removed, moved, changed from one dictionary to another; 1 when any is");
    diff->add_option("DIR_A", comparing.before, "the earlier dictionary's directory")->required();
    diff->add_option("DIR_B", comparing.after, "the later one's")->required();
    diff->add_flag("--json", comparing.json, "print one JSON object");
    diff->callback([&] { exit_code = timeline_diff(comparing); });

    auto* tones_command = app.add_subcommand("tones", "X-band tones from samples")->require_subcommand(1);
    TonesDecodeOptions listening;
    listening.shared = serving.shared;
    auto* heard = tones_command->add_subcommand("decode", "the tones in a file of complex samples, a line a symbol");
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
    auto* simulate = tones_command->add_subcommand("simulate", "writes such a file: from lists, or from a landing");
    simulate->add_option("--out", sending.out, "the file to write")->required();
    simulate->add_option("--rate", sending.rate_hz, "samples a second")->capture_default_str();
    simulate->add_option("--format", sending.format, "cf32 or ci16")->capture_default_str();
    simulate->add_option("--tones", sending.tones, "CSV: start_s,tone");
    simulate->add_option("--doppler", sending.doppler, "CSV of the Doppler: time, doppler_hz");
    auto* flown = simulate->add_option("--scenario", sending.scenario, "tones and Doppler of this landing instead");
    simulate->get_option("--tones")->excludes(flown);
    simulate->get_option("--doppler")->excludes(flown);
    simulate->add_option("--predict", sending.predict, "CSV of the Doppler to remove: time, doppler_hz");
    simulate->add_option("--predict-out", sending.predict_out, "make what ground expects, remove it, and write it here")
        ->excludes(simulate->get_option("--predict"));
    simulate->add_option("--from", sending.from_s, "time of the first sample [s]");
    simulate->add_option("--length", sending.length_s, "[s]");
    simulate->add_option("--c-n0", sending.c_n0_dbhz, "total power to noise density [dB-Hz]")->capture_default_str();
    simulate->add_option("--seed", sending.seed, "of the noise, and of the landing")
        ->check(whole_number())
        ->capture_default_str();
    simulate->add_option("--case", sending.case_number, "of the landing's errors")
        ->check(whole_number())
        ->capture_default_str();
    add_shared(*simulate, sending.shared);
    simulate->callback([&] { exit_code = tones_simulate(sending); });
    TonesBenchOptions measuring;
    measuring.shared = serving.shared;
    auto* measured =
        tones_command->add_subcommand("bench", "the receiver's figures beside theory; 1 when a goal is missed");
    measured->add_flag("--full", measuring.full, "the points that take long, too");
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
        command.add_option("--dictionary", options.shared.dictionary, "the mission's words")->capture_default_str();
        command.add_option("--xtce", options.xtce,
                           "the XTCE file of the mission that was followed, where it was not ours");
    };
    const auto add_selection = [&](CLI::App& command, ExportOptions& options) {
        add_archive_words(command, options.of);
        command.add_option("--run", options.of.run, "number of the run")->required()->check(whole_number());
        command
            .add_option("--channel,--channels", options.channels,
                        "names or aliases, several in a row or with commas between; left out: all")
            ->delimiter(',');
        command.add_option("--from", options.from_s, "first SCLK [s]; left out: all");
        command.add_option("--to", options.to_s, "last SCLK [s]; left out: all");
    };
    auto* export_command =
        app.add_subcommand("export", "a run's samples in order of SCLK, live and recorded as one series: a row a "
                                     "sample, in the same memory however many");
    add_selection(*export_command, exporting);
    auto* lines = export_command->add_option("--format", exporting.format, "csv or jsonl")
                      ->check(CLI::IsMember({"csv", "jsonl"}))
                      ->capture_default_str();
    export_command->add_flag("--csv")->description("as CSV, which is what it is without a word, too")->excludes(lines);
    export_command->add_option("--align", exporting.align,
                               "a line an instant and a column a channel: at the times of this one of the channels, "
                               "or at multiples of so many seconds; of each the newest value");
    export_command->add_option("--out", exporting.out, "a new file; left out: standard output");
    export_command->callback([&] { exit_code = export_samples(exporting); });

    SendOptions sending_file;
    auto* send_command = app.add_subcommand(
        "send", "sends a command file to a server: all of its commands are checked before the first goes, and "
                "when one is refused none goes; a line a command, 1 when nothing was sent, 3 when no answer says "
                "whether it was");
    send_command->add_option("--file", sending_file.file, "JSON, as POST /api/v1/runs/{run}/sequences takes it")
        ->required();
    send_command->add_option("--server", sending_file.server, "http://HOST:PORT or https://HOST:PORT")
        ->envname("AEOLIS_SERVER")
        ->capture_default_str();
    send_command
        ->add_option("--token", sending_file.token,
                     "of a server with accounts, over https or to this machine; others can read a command line, but "
                     "not AEOLIS_TOKEN")
        ->envname("AEOLIS_TOKEN");
    send_command->add_option("--authorities", sending_file.authorities,
                             "PEM file of who may have signed the server's certificate; left out: the system's");
    send_command->add_option("--by", sending_file.by,
                             "who asks, where the file does not say it and the server has no accounts");
    send_command->add_option("--run", sending_file.run, "only if this one goes on; left out: the one that goes on")
        ->check(whole_number());
    send_command->add_flag("--dry-run", sending_file.dry_run, "only say what would happen");
    send_command->callback([&] { exit_code = send(sending_file); });

    ReportOptions reporting{exporting.of};
    auto* report_command =
        app.add_subcommand("report", "a run as it was flown: when each timepoint and event came by plan, tone, UHF and "
                                     "recording, what was silent, and the proof");
    add_archive(*report_command, reporting.of.archive);
    report_command->add_option("--dictionary", reporting.of.shared.dictionary, "the mission's words")
        ->capture_default_str();
    report_command->add_option("--run", reporting.of.run, "number of the run")->required()->check(whole_number());
    auto* as_object = report_command->add_flag("--json", reporting.json, "print one JSON object");
    report_command->add_flag("--csv", reporting.csv, "print its timepoints and events, a row each")
        ->excludes(as_object);
    report_command->callback([&] { exit_code = report(reporting); });

    AccountsOptions keeping;
    auto* accounts_command =
        app.add_subcommand("accounts", "who may use a server: its file of accounts, by hand")->require_subcommand(1);
    auto* listed = accounts_command->add_subcommand("list", "users and tokens with their roles");
    listed->add_option("--accounts", keeping.file, "the file")->required()->envname("AEOLIS_ACCOUNTS");
    listed->callback([&] { exit_code = accounts_list(keeping); });
    auto* reset = accounts_command->add_subcommand(
        "reset",
        "a new password for a user who has lost theirs, or a new administrator; a server that runs takes it over");
    reset->add_option("--accounts", keeping.file, "the file")->required()->envname("AEOLIS_ACCOUNTS");
    reset->add_option("--user", keeping.user, "the name")->required();
    reset->callback([&] { exit_code = accounts_reset(keeping); });

    auto* archive_command =
        app.add_subcommand("archive", "what is done to an archive now and then")->require_subcommand(1);
    ArchiveOptions kept = exporting.of;
    auto* verify =
        archive_command->add_subcommand("verify", "the file's structure, sequence numbers, and every derived row "
                                                  "against the raw units, a line a fault; 1 when there is one");
    add_archive_words(*verify, kept);
    verify->add_option("--run", kept.run, "only this one")->check(whole_number());
    verify->callback([&] { exit_code = archive_verify(kept); });
    auto* rebuild =
        archive_command->add_subcommand("rebuild", "makes everything that follows from the raw units again and puts it "
                                                   "in place of what is there; no writer may go on");
    add_archive_words(*rebuild, kept);
    rebuild->add_option("--run", kept.run, "only this one")->check(whole_number());
    rebuild->callback([&] { exit_code = archive_rebuild(kept); });
    ExportOptions tabulating = exporting;
    auto* samples = archive_command->add_subcommand(
        "samples", "a run's samples as rows of an SQLite file, for questions in plain SQL");
    add_selection(*samples, tabulating);
    samples->add_option("--out", tabulating.out, "the new file")->required();
    samples->callback([&] { exit_code = archive_samples(tabulating); });
    PruneOptions pruning;
    pruning.archive = serving.archive;
    auto* prune = archive_command->add_subcommand("prune", "takes runs away; without --yes it says which");
    add_archive(*prune, pruning.archive);
    auto* gone =
        prune->add_option("--run", pruning.runs, "numbers, with commas between")->delimiter(',')->check(whole_number());
    prune->add_option("--keep", pruning.keep, "so many of the newest runs stay, all others go")
        ->check(whole_number())
        ->excludes(gone);
    prune->add_flag("--yes", pruning.yes, "do it");
    prune->callback([&] { exit_code = archive_prune(pruning); });
    auto* vacuum = archive_command->add_subcommand(
        "vacuum", "gives the room of pruned runs back to the disk; needs as much again meanwhile");
    add_archive(*vacuum, pruning.archive);
    vacuum->callback([&] { exit_code = archive_vacuum(pruning.archive); });
    std::filesystem::path backup_to;
    auto* backup = archive_command->add_subcommand(
        "backup", "the whole archive, as it is now, into a new file; a writer goes on meanwhile");
    add_archive(*backup, pruning.archive);
    backup->add_option("--out", backup_to, "the new file")->required();
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
