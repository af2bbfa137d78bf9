// SPDX-License-Identifier: Apache-2.0
#include "server/base/log_line.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/settings_file.hpp"
#include "server/cli/shipped_paths.hpp"
#include "server/cli/xtce_file.hpp"
#include "server/net/console_backend.hpp"
#include "server/shadow/forecast.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <memory>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <thread>

namespace aeolis::server {
namespace {

constexpr std::array<std::string_view, 4> log_levels{"debug", "info", "warn", "error"};
constexpr std::string_view default_log_level = "info";

struct ServeOptions {
    SharedOptions shared;
    std::filesystem::path settings;  ///< already read: settings_file.hpp
    std::string listen = "127.0.0.1:8080";
    std::filesystem::path archive = default_archive;
    std::filesystem::path web = shipped("web/dist");
    std::filesystem::path accounts;          ///< empty: none
    std::filesystem::path certificate, key;  ///< PEM; empty: no TLS
    std::vector<std::string> names;          ///< host names used by browsers
    std::vector<std::string> trusted_proxies;
    std::string scenario;  ///< empty: start none
    std::uint64_t seed = 1;
    double pace = 1.0;
    std::optional<std::string> downlink;  ///< "tcp://HOST:PORT", "udp://HOST:PORT": follow another mission
    MissionXtce xtce;                     ///< of the followed mission
    PacketStreamFormat format{};
    cluster::EngineAddress nats;  ///< how a NATS engine is reached, for the two below; its URL stays empty
    std::string publish_to;       ///< URL; empty: nowhere
    std::string follow;           ///< URL; empty: no other server is followed
    std::string follow_archive;   ///< of which archive, where the engine has several
    std::string follow_runs;      ///< numbers and ranges; empty: all runs
    HttpClient::Settings snapshots{
        .server = {}, .server_option = "--snapshot-from", .authorities_option = "--snapshot-ca"};
    std::filesystem::path snapshot_token;  ///< the file of its token; empty: the environment may have one
    std::filesystem::path follower_key;    ///< signs what people here ask of the origin
    std::uint64_t plan_flights = 300;
    std::uint64_t keep_raw_mb = archive::raw_octets_kept >> 20U;  ///< of each link of a run
    std::string log_level{default_log_level}, log_format = "text";
    bool log_level_given = false;  ///< by command line or environment, before which the file gives way
};

struct Listen {
    std::string address;
    std::uint16_t port = 0;
};

/// Parses "127.0.0.1:8080", "[::1]:8080", "localhost:8080".
std::optional<Listen> listen_of(const std::string& text) {
    const auto colon = text.rfind(':');
    if (colon == std::string::npos || colon == 0) return std::nullopt;
    Listen listen{text.substr(0, colon), 0};
    if (listen.address.starts_with('[') && listen.address.ends_with(']'))
        listen.address = listen.address.substr(1, listen.address.size() - 2);
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data() + colon + 1, end, listen.port);
    if (error != std::errc{} || stopped != end) return std::nullopt;
    return listen;
}

void set_log(const ServeOptions& options) {
    spdlog::set_level(spdlog::level::from_str(options.log_level));
    spdlog::set_formatter(options.log_format == "json" ? json_lines() : text_lines());
}

std::string what_to_do(const std::optional<simulation::Scenario>& scenario) {
    if (!scenario) return "Open it in a browser and start a rehearsal.";
    const auto* const waits_for = scenario->test_venue == simulation::TestVenue::gnc_alone
                                      ? "needs no commands: GNC flies alone, without a computer"
                                  : scenario->commands.empty() ? "waits for \"set edl parameters\" and \"do edl\""
                                                               : "sends its own commands";
    return fmt::format("Open it in a browser: the rehearsal '{}' has begun in the test venue {} and {}.",
                       scenario->name, name_of(scenario->test_venue), waits_for);
}

constexpr rlim_t files_besides_connections = 256;  // chosen: archive connections, campaigns, console files

/// Raises the limit of open files, by default mostly 1024: all streams and further connections need more.
void allow_open_files() {
    constexpr rlim_t wanted = WebServer::streams_max + WebServer::connections_besides + files_besides_connections;
    rlimit files{};
    if (::getrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_cur >= wanted) return;
    files.rlim_cur = std::min(wanted, files.rlim_max);
    ::setrlimit(RLIMIT_NOFILE, &files);
    if (files.rlim_cur < wanted)
        spdlog::warn("this process may have {} files open; all streams, and who asks besides, need {}", files.rlim_cur,
                     wanted);
}

/// A mission of which packets are followed, in place of rehearsals.
struct FollowedMission {
    int exit_code = 0;  ///< not 0: it cannot be followed, and has been said why
    std::unique_ptr<telemetry::OtherMission> model;
    DownlinkFollower::Settings link;
};

FollowedMission followed_mission(const ServeOptions& options) {
    const auto refused = [](int exit_code) { return FollowedMission{.exit_code = exit_code, .model = {}, .link = {}}; };
    auto address = DownlinkAddress::parse(*options.downlink);
    if (!address) return refused(failed("--downlink " + address.error().message, 2));
    if (const auto checked = check_format(options.format); !checked) return refused(failed(checked.error().message, 2));
    auto xtce = read_xtce(options.xtce);
    if (!xtce) return refused(xtce.exit_code);
    FollowedMission mission;
    mission.model = std::make_unique<telemetry::OtherMission>(std::move(*xtce.model), xtce.id, std::move(xtce.time));
    if (mission.model->omitted_fields() > 0)
        spdlog::warn("{}: more numbers than can be channels: the rest is in the packets only", options.xtce.text());
    for (const auto& line : mission.model->unsupported_alarms()) spdlog::warn("{}: {}", options.xtce.text(), line);
    mission.link = DownlinkFollower::Settings{.address = *address,
                                              .format = options.format,
                                              .xtce = options.xtce.text(),
                                              .retry_first = std::chrono::milliseconds{250},
                                              .retry_max = std::chrono::milliseconds{30'000}};
    return mission;
}

/// SIGINT, SIGTERM and SIGHUP as something to wait for. Made before any thread: all of them inherit that they are
/// blocked.
class Signals {
  public:
    Signals() {
        sigemptyset(&signals_);
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals_, signal);
        pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    }
    int wait() const {
        int signal = 0;
        sigwait(&signals_, &signal);
        return signal;
    }

  private:
    sigset_t signals_{};
};

/// At once: whatever fails later, this is the only time that the password can be read.
void print_first_password(const ConsoleBackend& backend, const std::filesystem::path& accounts) {
    const auto& password = backend.first_password();
    if (password.empty()) return;
    print_line(stdout, fmt::format("No accounts yet: {} was made.", accounts.string()));
    print_line(stdout, fmt::format("  Log in as administrator with {}", password));
    print_line(stdout, "  It is shown this once, and only lets you choose a password of your own.");
    std::fflush(stdout);
}

void print_address(const ConsoleBackend& backend, const Listen& listen, const std::string& next_step,
                   const ServeOptions& options) {
    print_line(stdout,
               fmt::format("Aeolis is at {}://{}:{}/", backend.secure() ? "https" : "http",
                           listen.address.find(':') == std::string::npos ? listen.address : '[' + listen.address + ']',
                           backend.port()));
    print_line(stdout, "  " + next_step);
    print_line(stdout, fmt::format("  archive {}; {}; end with Ctrl-C",
                                   std::filesystem::absolute(options.archive).lexically_normal().string(),
                                   options.accounts.empty() ? "no accounts: whoever uses this machine may command"
                                                            : "accounts in " + options.accounts.string()));
    std::fflush(stdout);
}

/// SIGHUP: certificate, accounts and, where the file of settings decides it, the log level are read again. What cannot
/// be read stays as it was.
void read_again(ConsoleBackend& backend, const ServeOptions& options) {
    spdlog::info("asked to read certificate, accounts and log level again");
    if (!options.settings.empty() && !options.log_level_given) {
        const auto level = setting_in_file(options.settings, "log-level");
        if (!level)
            spdlog::error("{}; the log level stays", level.error().message);
        else if (const auto named = level->value_or(std::string{default_log_level});
                 std::ranges::find(log_levels, named) == log_levels.end())
            spdlog::error("{}: log-level: '{}' is none of {}; it stays", options.settings.string(), named,
                          fmt::join(log_levels, ", "));
        else
            spdlog::set_level(spdlog::level::from_str(named));
    }
    backend.renew_certificate();
}

void run_until_signal(ConsoleBackend& backend, const Signals& signals, const ServeOptions& options) {
    std::thread waiter{[&] {
        int signal = signals.wait();
        for (; signal == SIGHUP; signal = signals.wait()) read_again(backend, options);
        spdlog::info("{}: ending", signal == SIGINT ? "interrupted" : "asked to end");
        backend.stop();
    }};
    backend.run();
    waiter.join();
}

/// The server from which runs are fetched, with its token.
Result<HttpClient::Settings> snapshots_of(const ServeOptions& options) {
    auto snapshots = options.snapshots;
    if (!options.snapshot_token.empty()) {
        std::ifstream file{options.snapshot_token};
        if (!(file >> snapshots.token))
            return Error{
                fmt::format("--snapshot-token-file {}: no token can be read in it", options.snapshot_token.string())};
    } else if (const char* token = std::getenv("AEOLIS_SNAPSHOT_TOKEN"); token != nullptr) {
        snapshots.token = token;
    }
    if (snapshots.server.empty()) snapshots.token.clear();
    return snapshots;
}

cluster::EngineAddress engine_at(cluster::EngineAddress credentials, const std::string& url) {
    credentials.url = url;
    return credentials;
}

int serve(const ServeOptions& options) {
    set_log(options);
    allow_open_files();
    const auto runs = options.follow_runs.empty() ? Result<cluster::ChosenRuns>{cluster::ChosenRuns{}}
                                                  : cluster::ChosenRuns::parse(options.follow_runs);
    if (!runs) return failed("--follow-runs " + runs.error().message, 2);
    const auto snapshots = snapshots_of(options);
    if (!snapshots) return failed(snapshots.error().message, 2);
    const auto listen = listen_of(options.listen);
    if (!listen)
        return failed(fmt::format("--listen {}: expected ADDRESS:PORT, such as 127.0.0.1:8080", options.listen), 2);
    FollowedMission followed;
    if (options.downlink) followed = followed_mission(options);
    if (followed.exit_code != 0) return followed.exit_code;
    const auto dictionary = followed.model ? Result<dictionary::Dictionary>{followed.model->dictionary()}
                                           : dictionary_of_flight(options.shared.dictionary);
    if (!dictionary) return failed(dictionary.error().message);
    std::optional<simulation::Scenario> scenario;
    if (!options.scenario.empty()) {
        auto given = scenario_given(options.scenario, options.shared.scenarios);
        if (!given) return failed(given.error().message);
        scenario = std::move(*given);
    }

    const Signals signals;
    auto opened = ConsoleBackend::open({.web_server = {.address = listen->address,
                                                       .port = listen->port,
                                                       .names = options.names,
                                                       .trusted_proxies = options.trusted_proxies,
                                                       .certificate = options.certificate,
                                                       .key = options.key},
                                        .accounts = options.accounts,
                                        .archive = options.archive,
                                        .scenarios = options.shared.scenarios,
                                        .web = options.web,
                                        .dictionary = options.shared.dictionary,
                                        .other = followed.model.get(),
                                        .raw_octets_kept = options.keep_raw_mb << 20U,
                                        .plan_flights = options.plan_flights,
                                        .publish_to = engine_at(options.nats, options.publish_to),
                                        .follow_by = engine_at(options.nats, options.follow),
                                        .follow_archive = options.follow_archive,
                                        .follow_runs = *runs,
                                        .snapshots = *snapshots,
                                        .follower_key = options.follower_key},
                                       *dictionary);
    if (!opened) return failed(opened.error().message);
    auto& backend = **opened;
    print_first_password(backend, options.accounts);
    if (options.downlink)
        if (auto following = backend.follow(followed.link); !following)
            return failed("--downlink " + following.error().message);
    if (scenario) backend.start({*scenario, options.seed, options.pace});
    print_address(backend, *listen,
                  !options.follow.empty() ? "Open it in a browser: it follows another server."
                  : options.downlink      ? "Open it in a browser: it follows " + followed.link.address.text() + "."
                                          : what_to_do(scenario),
                  options);
    run_until_signal(backend, signals, options);
    return 0;
}

void add_backend_options(CLI::App& command, ServeOptions& options) {
    command.add_option("--config", options.settings, "file of options");
    command
        .add_option(
            "--listen", options.listen,
            "ADDRESS:PORT; port 0 takes a free one. An address that other machines reach needs --accounts and TLS")
        ->capture_default_str();
    command.add_option("--accounts", options.accounts,
                       "file of users and tokens, created at the first start; without it nobody logs in, and only "
                       "loopback can be used");
    command.add_option("--tls-certificate", options.certificate,
                       "PEM file with the server's certificate and its chain; serves https only");
    command.add_option("--tls-key", options.key, "PEM file with its private key");
    command
        .add_option("--host", options.names,
                    "names by which browsers call this server, separated by commas; loopback names always work")
        ->delimiter(',');
    command
        .add_option("--trusted-proxies", options.trusted_proxies,
                    "addresses and networks of the proxies in front of this server, separated by commas: clients are "
                    "told apart by the X-Forwarded-For that the proxies send")
        ->delimiter(',');
    command.add_option("--archive", options.archive, "SQLite file that keeps everything")->capture_default_str();
    command
        .add_option(
            "--keep-raw", options.keep_raw_mb,
            "MB (2^20 octets) that are kept of each link of a run as received, bad frames too; the oldest beyond that "
            "are removed; 0: none")
        ->check(CLI::Range(0, 1 << 20))
        ->capture_default_str();
    command
        .add_option("--plan-flights", options.plan_flights,
                    "dispersed flights of ground's plan, made beside each run by processors that nothing else wants: "
                    "they say when each timepoint is expected and what the vehicle may do; 0: none; below 199 no "
                    "interval is told")
        ->check(CLI::Range(std::uint64_t{0}, shadow::forecast_cases_max))
        ->capture_default_str();
    command.add_option("--web", options.web, "directory of the built console")->capture_default_str();
    command.add_option("--log-level", options.log_level, "least severe level that is logged to standard error")
        ->check(CLI::IsMember(std::vector<std::string>{log_levels.begin(), log_levels.end()}))
        ->capture_default_str();
    command.add_option("--log-format", options.log_format, "text for people, or json: an object per line")
        ->check(CLI::IsMember({"text", "json"}))
        ->capture_default_str();
}

/// Adds what is shared with servers on other machines (docs/scale.md).
void add_cluster_options(CLI::App& command, ServeOptions& options) {
    auto* publish = command.add_option("--nats", options.publish_to,
                                       "publish what is committed to this NATS engine, nats://HOST:PORT, for servers "
                                       "that follow this one");
    auto* follow = command
                       .add_option("--follow", options.follow,
                                   "follow the server that publishes to this NATS engine: an archive of the same runs, "
                                   "for browsers and programs that only watch")
                       ->excludes(publish);
    command
        .add_option("--follow-archive", options.follow_archive,
                    "identity of that server's archive, or its beginning, where the engine has several")
        ->needs(follow);
    command
        .add_option("--follow-runs", options.follow_runs,
                    "the runs to follow, such as 3,5-8,12- (12 and all later ones); all if left out")
        ->needs(follow);
    auto* from = command
                     .add_option("--snapshot-from", options.snapshots.server,
                                 "http://HOST:PORT or https://HOST:PORT of the origin or another follower: gives what "
                                 "the engine no longer has; AEOLIS_SNAPSHOT_TOKEN has its token, of an instructor")
                     ->needs(follow);
    command.add_option("--snapshot-token-file", options.snapshot_token, "file with that token")->needs(from);
    command
        .add_option("--snapshot-ca", options.snapshots.authorities,
                    "PEM file of the authorities that may have signed that server's certificate; the system's if left "
                    "out")
        ->needs(from);
    command
        .add_option("--follower-key", options.follower_key,
                    "key of this follower (aeolis accounts follower-key): people with accounts here may command, where "
                    "the origin lists the key and has accounts of their names")
        ->needs(follow);
    for (const char* other : {"--scenario", "--downlink"}) follow->excludes(command.get_option(other));
    add_engine_credentials(command, options.nats);
}

CLI::Validator pace() {
    return {[](std::string& text) {
                const double given = std::strtod(text.c_str(), nullptr);
                return given == 0.0 || (given >= 1.0 && given <= 1000.0) ? std::string{}
                                                                         : "neither 0 nor within 1 … 1000: " + text;
            },
            "PACE"};
}

/// Adds the options for the rehearsal to start, or the mission to follow.
void add_run_options(CLI::App& command, ServeOptions& options) {
    auto* scenario = command.add_option("--scenario", options.scenario,
                                        "rehearsal to start at once: a file, or the name of a shipped one");
    auto* downlink =
        command
            .add_option(
                "--downlink", options.downlink,
                "follow another mission instead of rehearsing: tcp://HOST:PORT connects, and reconnects "
                "after every end, waiting longer each time up to 30 s; udp://HOST:PORT listens (with "
                "--format packets, tm and aos each datagram holds whole ones). What arrives is a run of its own: "
                "its packets, and their numbers as channels, are in stream, archive and API")
            ->excludes(scenario);
    auto* xtce = add_mission_xtce(command, options.xtce,
                                  "that mission's XTCE file; may be given several times. Unsupported parts are named "
                                  "with their lines");
    downlink->needs(xtce->needs(downlink));
    for (auto* option : add_stream_format(command, options.format)) option->needs(downlink);
    command.add_option("--seed", options.seed, "seed of that rehearsal's errors")
        ->check(whole_number())
        ->capture_default_str();
    command.add_option("--pace", options.pace, "pace of that rehearsal: 1 … 1000, or 0 for as fast as it goes")
        ->check(pace())
        ->capture_default_str();
}

}  // namespace

void add_serve_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<ServeOptions>();
    auto& command = *program.add_subcommand("serve", "serves the console: open the address it prints in a browser.\n"
                                                     "Each option can also stand in a file (--config), a line each "
                                                     "without its dashes: archive=/var/lib/aeolis/aeolis.db.\n"
                                                     "The command line takes precedence over the environment "
                                                     "variable named beside an option, and that over the file.");
    add_backend_options(command, *options);
    add_run_options(command, *options);
    add_cluster_options(command, *options);
    add_shared(command, options->shared);
    name_environment(command);
    command.callback([options, &exit_code, level = command.get_option("--log-level")] {
        options->log_level_given = level->count() > 0;
        exit_code = serve(*options);
    });
}

}  // namespace aeolis::server
