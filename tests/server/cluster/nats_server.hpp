// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/child_process.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::tests {

/// A nats-server with JetStream on a port of its own, with its streams in a folder that is removed with it. It can be
/// killed, and started again with the same streams. AEOLIS_NATS_SERVER names the program (./test unpacks Debian's).
class NatsServer {
  public:
    /// Whether there is such a program. If not, says on the output that a test was skipped.
    static bool present();

    enum class JetStream : std::uint8_t { present, absent };
    explicit NatsServer(JetStream streams = JetStream::present);
    /// With further options.
    explicit NatsServer(std::vector<std::string> options);
    NatsServer(const NatsServer&) = delete;
    NatsServer& operator=(const NatsServer&) = delete;

    std::string url() const;
    std::uint16_t port() const { return port_; }
    void kill();  ///< as by kill -9
    void start();
    /// Removes what its streams hold; only while it is killed.
    void forget();

    static std::uint16_t free_port();  ///< that nobody has now

  private:
    test::TemporaryFolder folder_;
    JetStream streams_;
    std::vector<std::string> options_;
    std::uint16_t port_ = 0;
    std::optional<test::ChildProcess> process_;
};

/// Three engines that can keep each stream three times.
class NatsCluster {
  public:
    static constexpr std::size_t engines = 3;
    NatsCluster();

    std::string url() const;  ///< of all three
    NatsServer& at(std::size_t engine) { return *servers_.at(engine); }
    /// As the engines know it.
    static std::string name_of(std::size_t engine) { return "engine-" + std::to_string(engine); }

  private:
    std::vector<std::unique_ptr<NatsServer>> servers_;
};

}  // namespace aeolis::tests
