// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/records.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::server::cluster {

/// The runs that a follower takes.
class ChosenRuns {
  public:
    /// All of them.
    ChosenRuns() = default;
    /// Numbers and ranges with commas between them: "3", "5-8", "12-" (and all later ones).
    static Result<ChosenRuns> parse(const std::string& text);

    bool has(archive::RunId run) const;
    const std::string& text() const { return text_; }  ///< as given; empty: all

  private:
    std::string text_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges_;  ///< first and last; none: all
};

}  // namespace aeolis::server::cluster
