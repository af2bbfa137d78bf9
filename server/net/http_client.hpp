// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace aeolis::server {

/// Sends one request to an Aeolis server and reads its answer; used by the program's own subcommands, and by servers
/// that fetch runs.
///
/// In       http://HOST[:PORT] or https://HOST[:PORT]      Out   status and body
/// TLS      the server's certificate must have that name and be signed by one of `authorities` (empty: the system's)
/// Token    sent over https or to loopback only: over http others on the way could read it
/// Faults   an Error in words when the request did not reach the server. A failure between request and answer is
///          reported in the answer, since the server may have carried out the request. An answer of any status is an
///          answer
/// Blocks   the caller: `patience` at most for each of connecting, TLS handshake and sending, `answer_patience` for the
///          answer. Name look-up has the system's own limits
class HttpClient {
  public:
    static constexpr std::size_t answer_octets_max = 8 << 20;  ///< chosen: ten times the answer to 100 commands

    struct Settings {
        std::string server;                   ///< the URL
        std::string token{};                  ///< empty: none
        std::filesystem::path authorities{};  ///< PEM
        /// The options that name the two, for messages.
        const char* server_option = "--server";
        const char* authorities_option = "--authorities";
        std::chrono::seconds patience{30};  ///< chosen
        std::chrono::seconds answer_patience{
            60};  ///< chosen: a command may wait for its turn (5 s), an analysis (20 s) and a queue
    };
    struct Answer {
        unsigned status = 0;
        std::string body{};
        std::string lost{};  ///< why the answer is incomplete though the server may have the request; else empty
    };
    explicit HttpClient(Settings settings) : settings_(std::move(settings)) {}

    /// Whether requests can be sent at all: the URL is one, its authorities can be read, the token may go there.
    Result<void> check() const;
    /// Posts a request. An Error means that the server did not receive all of it.
    Result<Answer> post(const std::string& path, const std::string& json) const;

    using Take = std::function<bool(std::string_view part)>;  ///< false: no more of the body is wanted
    using Stop = std::function<bool()>;                       ///< asked several times a second
    /// Gets an answer of any length, in the memory of a part of it. The body of status 200 goes to `take`, which may
    /// wait; that of another status, as far as `problem_octets_max`, is in the answer.
    Result<Answer> get(const std::string& path, const Take& take, const Stop& stop) const;
    static constexpr std::size_t problem_octets_max = 64 << 10;  ///< chosen: a problem is a sentence

  private:
    Settings settings_;
};

}  // namespace aeolis::server
