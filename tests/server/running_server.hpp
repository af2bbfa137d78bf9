// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/net/console_backend.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <spdlog/spdlog.h>
#include <thread>

namespace aeolis::test {

inline const std::filesystem::path shipped_scenarios = AEOLIS_SOURCE_DIR "/simulation/scenarios";

/// A landing that begins close to entry, so that a test sees much in little time.
inline simulation::Scenario shipped_scenario(const char* name) {
    auto scenario = server::scenario_from_file(shipped_scenarios / (std::string{name} + ".textproto"));
    REQUIRE(scenario);
    return *scenario;
}

/// One that is flown from its script in seconds, with tones drawn from the symbol error.
inline simulation::Scenario short_landing() {
    auto scenario = shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 900.0;
    scenario.commands[0].send_before_entry_s = 895.0;
    scenario.commands[1].send_before_entry_s = 885.0;
    scenario.radio.tones_from_samples = false;
    return scenario;
}

/// `aeolis serve` on a free port with an archive of its own, in this process.
class RunningServer {
  public:
    RunningServer() {
        open();
        start_thread();
    }
    explicit RunningServer(const simulation::Scenario& scenario, double pace) {
        open();
        backend_->start({scenario, 1, pace});
        start_thread();
    }
    ~RunningServer() { end(); }

    /// Selects a server with accounts, whose file is in the folder of the archive.
    struct WithAccounts {};
    explicit RunningServer(WithAccounts) {
        accounts_ = folder_ / "accounts.json";
        open();
        start_thread();
    }

    /// Starts a server with clocks that the test moves.
    explicit RunningServer(server::ReadClocks clocks) : clocks_(std::move(clocks)) {
        open();
        start_thread();
    }

    struct Secure {
        std::filesystem::path certificate, key;
    };
    explicit RunningServer(const Secure& tls) {
        accounts_ = folder_ / "accounts.json";
        web_server_.certificate = tls.certificate;
        web_server_.key = tls.key;
        open();
        start_thread();
    }

    std::uint16_t port() const { return port_; }
    std::string first_password() const { return backend_->first_password(); }
    std::filesystem::path accounts() const { return accounts_; }
    /// Ends it and opens the same archive again, as a restart does.
    void restart() {
        end();
        open();
        start_thread();
    }
    void renew_certificate() { backend_->renew_certificate(); }
    std::filesystem::path archive() const { return folder_ / "a.db"; }
    /// Ends it as a signal to the program does.
    void end() {
        if (!backend_) return;
        backend_->stop();
        network_.join();
        backend_.reset();
    }

  private:
    void open() {
        spdlog::set_level(spdlog::level::off);  // what a test provokes need not be read
        server::ConsoleBackend::Settings settings;
        settings.web_server = web_server_;
        settings.accounts = accounts_;
        settings.archive = archive();
        settings.scenarios = shipped_scenarios;
        settings.dictionary = AEOLIS_SOURCE_DIR "/dictionaries/msl";
        settings.web = folder_ / "web";
        settings.clocks = clocks_;
        auto backend = server::ConsoleBackend::open(settings, tests::shipped_dictionary());
        REQUIRE(backend);
        backend_ = std::move(*backend);
        port_ = backend_->port();
    }
    void start_thread() {
        network_ = std::thread{[this] { backend_->run(); }};
    }

    TemporaryFolder folder_;
    std::filesystem::path accounts_;
    server::WebServer::Settings web_server_;
    server::ReadClocks clocks_ = server::read_clocks;
    std::unique_ptr<server::ConsoleBackend> backend_;
    std::thread network_;
    std::uint16_t port_ = 0;
};

}  // namespace aeolis::test
