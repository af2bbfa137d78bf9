// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// The query string of a request (after '?'): names and values, decoded.
class QueryText {
  public:
    /// Parses the query string. Fails on bad percent-encoding, a repeated name, or a name that is not among `known`.
    static Result<QueryText> parse(std::string_view encoded, const std::vector<std::string_view>& known);

    std::optional<std::string> text(std::string_view name) const;
    /// A finite number; none when absent or empty.
    Result<std::optional<double>> number(std::string_view name) const;
    /// A whole number from 0 to `max`, decimal or 0x hexadecimal.
    Result<std::optional<std::uint64_t>> count(std::string_view name, std::uint64_t max) const;
    /// A whole number from 1 to `max`, for the size of a page or the like.
    Result<std::optional<std::uint64_t>> amount(std::string_view name, std::uint64_t max) const;
    /// One of `words`; the first of them when absent.
    Result<std::string> one_of(std::string_view name, std::span<const std::string_view> words) const;
    /// The parts between commas, without empty ones.
    std::vector<std::string> list(std::string_view name) const;

  private:
    std::vector<std::pair<std::string, std::string>> values_;
};

}  // namespace aeolis::server
