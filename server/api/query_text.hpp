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

/// The part of a request's target after '?': names and values, decoded.
class QueryText {
  public:
    /// Fails on bad percent-encoding, a name given twice, or a name that is not among `known`.
    static Result<QueryText> parse(std::string_view encoded, const std::vector<std::string_view>& known);

    std::optional<std::string> text(std::string_view name) const;
    /// Finite; none when not given or empty.
    Result<std::optional<double>> number(std::string_view name) const;
    /// A whole number from 0, decimal or 0x hexadecimal, `max` at most.
    Result<std::optional<std::uint64_t>> count(std::string_view name, std::uint64_t max) const;
    /// The same of what can be asked for: from 1.
    Result<std::optional<std::uint64_t>> amount(std::string_view name, std::uint64_t max) const;
    /// One of `words`; the first of them when not given.
    Result<std::string> one_of(std::string_view name, std::span<const std::string_view> words) const;
    /// Separated by commas, empty ones left out.
    std::vector<std::string> list(std::string_view name) const;

  private:
    std::vector<std::pair<std::string, std::string>> values_;
};

}  // namespace aeolis::server
