// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace aeolis::archive {

inline constexpr std::size_t expression_octets_max = 1'000;
inline constexpr std::size_t expression_channels_max = 16;

/// A formula over channels: "sqrt(nav_velocity_x_mps^2 + {GNC-0102}^2)". A word is a channel's name; braces hold a name
/// or alias with any characters. Operators, functions and the constants _pi and _e are muParser's; assignment is not
/// allowed.
class Expression {
  public:
    /// Parses a formula. The Error gives the position in `text`, counted from 1, and the fault there.
    static Result<Expression> parse(const std::string& text);
    Expression(Expression&&) noexcept;
    Expression& operator=(Expression&&) noexcept;
    ~Expression();

    /// The channels in the formula, at least one, in the order of first appearance.
    const std::vector<std::string>& channels() const;
    /// Evaluates the formula; NaN and infinities where arithmetic gives them.
    /// @param values  one per channel, in the order of channels()
    double value(std::span<const double> values);

  private:
    struct State;
    explicit Expression(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;  ///< muParser holds addresses in it
};

}  // namespace aeolis::archive
