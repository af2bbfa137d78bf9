// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace aeolis::bench {

/// Programs that ask for lists over HTTP, all at the same time, in a process of their own so that their memory and
/// their time are not charged to the server.
class ListReaders {
  public:
    /// Chosen: fewer than the server's places for connections besides streams, which a closing one holds for a moment.
    static constexpr std::size_t readers = 48;
    /// Each reader asks for each target once, the next when it has the answer; each begins with another one.
    /// Forks: call before any thread starts.
    explicit ListReaders(std::vector<std::string> targets);
    ~ListReaders();

    /// @param tokens  of programs; the readers have them in turn, one each
    void begin(std::uint16_t port, const std::vector<std::string>& tokens);
    bool over() const { return board_->over == readers; }

    std::uint64_t answers() const { return board_->answers; }
    std::uint64_t refused() const { return board_->refused; }  ///< answers other than 200
    std::uint64_t octets() const { return board_->octets; }
    double longest_ms() const { return static_cast<double>(board_->longest_us) * 1e-3; }

  private:
    struct Board {
        std::atomic<std::uint16_t> port{0};
        std::atomic<std::size_t> over{0};
        std::atomic<std::uint64_t> answers{0}, refused{0}, octets{0}, longest_us{0};
        std::array<std::array<char, 128>, readers> tokens{};
    };
    static void read_lists(Board& board, std::size_t reader, const std::vector<std::string>& targets);

    Board* board_;
    int process_ = -1;
};

}  // namespace aeolis::bench
