// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <chrono>
#include <filesystem>
#include <string>

namespace aeolis::server {

/// One request to a server of ours, and its answer: what the program itself asks of a server that runs.
///
/// In       http://HOST[:PORT] or https://HOST[:PORT]      Out   status and body
/// TLS      the server's certificate must be of that name and signed by one of `authorities`, or of the system's where
///          that is empty
/// Token    over https, or to this machine itself: over http others on the way could read it
/// Faults   whatever keeps the request away from the server, in words: it has not got it. What comes between the
///          request and its answer is told in the answer, for the server may have done what was asked. An answer of any
///          status is an answer
/// Blocks the caller, `patience` at most for each of connecting, making it safe and sending, `answer_patience` for the
/// answer; a
///          name is looked up by the system, by whose limits it is.
class HttpClient {
  public:
    static constexpr std::size_t answer_octets_max =
        8 << 20;  ///< ours: a hundred commands with all that is told of them take a tenth

    struct Settings {
        std::string server;                   ///< the URL
        std::string token{};                  ///< empty: none
        std::filesystem::path authorities{};  ///< PEM
        std::chrono::seconds patience{30};    ///< ours
        std::chrono::seconds answer_patience{
            60};  ///< ours: a command may wait for a turn, 5 s, and for an analysis, 20 s, after others in a queue
    };
    struct Answer {
        unsigned status = 0;
        std::string body{};
        std::string lost{};  ///< not empty: why no whole answer came to a request that the server may have got
    };
    explicit HttpClient(Settings settings) : settings_(std::move(settings)) {}

    /// An Error: nothing was sent, or not all of it.
    Result<Answer> post(const std::string& path, const std::string& json) const;

  private:
    Settings settings_;
};

}  // namespace aeolis::server
