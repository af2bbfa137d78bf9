// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/links/frame_format.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// The subcommands of `aeolis`: each takes what was given and returns the exit code: 0 done, 1 failed or found
// something, 2 bad use, 3 not known whether it was done.
namespace aeolis::server {

struct SharedOptions {
    std::filesystem::path dictionary, scenarios;
};

struct ServeOptions {
    SharedOptions shared;
    std::string listen = "127.0.0.1:8080";
    std::filesystem::path archive = "run-data/aeolis.db";
    std::filesystem::path web;
    std::filesystem::path accounts;          ///< empty: none
    std::filesystem::path certificate, key;  ///< PEM; empty: no TLS
    std::vector<std::string> names;          ///< by which browsers call the server
    std::string scenario;                    ///< empty: none is started
    std::uint64_t seed = 1;
    double pace = 1.0;
    std::optional<std::string> downlink;  ///< "tcp://HOST:PORT", "udp://HOST:PORT": follow another mission
    std::filesystem::path xtce;           ///< of that mission
    DownlinkForm format{};
    std::string log_level = "info", log_format = "text";
};
int serve(const ServeOptions& options);

struct AccountsOptions {
    std::filesystem::path file;
    std::string user;
};
/// Prints users and tokens of a file of accounts.
int accounts_list(const AccountsOptions& options);
/// Gives a user a new password, or makes an administrator of that name; prints the password.
int accounts_reset(const AccountsOptions& options);

struct SendOptions {
    std::filesystem::path file;  ///< a command file: a CommandSequence as JSON
    std::string server = "http://127.0.0.1:8080";
    std::string token;                  ///< of a server with accounts
    std::filesystem::path authorities;  ///< PEM; empty: the system's
    std::string by;                     ///< who asks, where the file does not say it
    std::optional<std::uint32_t> run;   ///< the one that goes on
    bool dry_run = false;
};
/// Sends a command file to a server; 0 when all was taken, 3 when it is not known whether it was, else nothing was.
int send(const SendOptions& options);

struct RehearseOptions {
    SharedOptions shared;
    std::string scenario;
    std::uint64_t seed = 1, case_number = 0;
    std::optional<std::filesystem::path> archive;
    std::optional<std::filesystem::path> truth;  ///< 16 rows a second of what really happened, as CSV
    bool json = false;
};
int rehearse(const RehearseOptions& options);

/// Of every question to an archive's runs.
struct ArchiveOptions {
    SharedOptions shared;
    std::filesystem::path archive;
    std::filesystem::path xtce;  ///< of the mission that was followed; empty: our own
    std::optional<std::uint32_t> run;
};
struct ReportOptions {
    ArchiveOptions of;
    bool json = false, csv = false;
};
/// Prints a run as it was flown.
int report(const ReportOptions& options);

struct ExportOptions {
    ArchiveOptions of;
    std::vector<std::string> channels;   ///< empty: all
    std::optional<double> from_s, to_s;  ///< SCLK, both included
    std::string format = "csv";          ///< csv, jsonl
    std::string align;                   ///< as SampleText::Options has it
    std::filesystem::path out;           ///< empty: the standard output
};
/// Writes a line a sample, or a line an instant.
int export_samples(const ExportOptions& options);
/// The same rows as a table of an SQLite file `out`.
int archive_samples(const ExportOptions& options);

/// 0 when nothing is wrong.
int archive_verify(const ArchiveOptions& options);
/// 0 when every run was made again.
int archive_rebuild(const ArchiveOptions& options);

struct PruneOptions {
    std::filesystem::path archive;
    std::vector<std::uint32_t> runs;
    std::optional<std::size_t> keep;  ///< the newest so many stay
    bool yes = false;                 ///< else it only says what it would do
};
int archive_prune(const PruneOptions& options);
int archive_vacuum(const std::filesystem::path& archive);
int archive_backup(const std::filesystem::path& archive, const std::filesystem::path& copy);

struct CampaignOptions {
    SharedOptions shared;
    std::string scenario;
    std::uint64_t cases = 0, seed = 1;
    unsigned jobs = 0;                             ///< 0: one a processor
    std::optional<std::filesystem::path> results;  ///< else run-data/campaign-SCENARIO-SEED.db
    std::optional<std::filesystem::path> plots;    ///< a directory
    bool json = false;
};
/// 0 when all cases are flown and each ended in touchdown.
int run_campaign(const CampaignOptions& options);

struct ModulesOptions {
    SharedOptions shared;
    std::string scenario = "nominal_auto";
    std::uint64_t seed = 1;
};
/// Prints the flight software's modules, messages, rates and priorities as a document.
int modules(const ModulesOptions& options);

struct EntryReferenceOptions {
    SharedOptions shared;
    std::string scenario;
};
/// Prints the tables that entry guidance follows in a scenario, as CSV.
int entry_reference(const EntryReferenceOptions& options);

struct DecodeOptions {
    std::filesystem::path xtce, packets;
    DownlinkForm format{};
    std::optional<std::filesystem::path> clock_kernel,
        leap_seconds;                      ///< SPICE text kernels: both, or leap seconds alone
    std::optional<std::size_t> partition;  ///< of the clock
    bool csv = false;
};
/// Prints any mission's packets by its XTCE file; 0 when every octet was decoded.
int decode(const DecodeOptions& options);

int dictionary_check(const std::filesystem::path& path);
/// Writes the whole dictionary as one XTCE file, to `out` or, where it is empty, to the standard output.
int dictionary_export(const std::filesystem::path& path, const std::filesystem::path& out);
/// Prints the state machines as diagrams.
int dictionary_diagram(const std::filesystem::path& directory);

struct TimelineAnalyseOptions {
    std::filesystem::path directory;
    bool json = false;
};
/// 0 when every required row of constraints.csv is proven.
int timeline_analyse(const TimelineAnalyseOptions& options);

struct TimelineDiffOptions {
    std::filesystem::path before, after;
    bool json = false;
};
/// 0 when no row differs.
int timeline_diff(const TimelineDiffOptions& options);

struct TonesDecodeOptions {
    SharedOptions shared;
    std::filesystem::path samples;
    double rate_hz = 0.0;
    std::string format;
    std::optional<std::filesystem::path> predict;  ///< what was removed before sampling
    double start_s = 0.0;                          ///< of the first sample, in the predict's time
    bool json = false;
};
/// Prints a line a symbol. 1 when there is silence, no carrier, or a long carrier without any symbol.
int tones_decode(const TonesDecodeOptions& options);

struct TonesSimulateOptions {
    SharedOptions shared;
    std::filesystem::path out;
    double rate_hz = 16384.0;
    std::string format = "cf32";
    std::optional<std::string> scenario;  ///< the tones and Doppler of a landing, from entry interface
    std::optional<std::filesystem::path> tones, doppler, predict;
    std::optional<std::filesystem::path> predict_out;  ///< made here instead: what ground expects
    std::optional<double> from_s, length_s;
    double c_n0_dbhz = 22.0;
    std::uint64_t seed = 1, case_number = 0;
};
/// Writes a file of samples.
int tones_simulate(const TonesSimulateOptions& options);

struct TonesBenchOptions {
    SharedOptions shared;
    bool full = false;
};
/// Prints the receiver's figures beside their goals; 1 when one is missed.
int tones_bench(const TonesBenchOptions& options);

}  // namespace aeolis::server
