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

/// A formula of channels: "sqrt(nav_velocity_x_mps^2 + {GNC-0102}^2)". A word is a channel's name; braces hold a name
/// or an alias of any letters. Operators, functions and the constants _pi and _e are those of muParser; assignment is
/// not.
class Expression {
  public:
    /// An Error says at which character of `text`, from 1, and what is wrong there.
    static Result<Expression> parse(const std::string& text);
    Expression(Expression&&) noexcept;
    Expression& operator=(Expression&&) noexcept;
    ~Expression();

    /// The channels in it, in the order of their first appearance; one at least.
    const std::vector<std::string>& channels() const;
    /// @param values  one a channel, in that order
    /// NaN and infinities where arithmetic gives them.
    double value(std::span<const double> values);

  private:
    struct State;
    explicit Expression(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;  ///< muParser holds addresses in it
};

}  // namespace aeolis::archive
