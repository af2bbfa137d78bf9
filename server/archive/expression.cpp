// SPDX-License-Identifier: Apache-2.0
#include "server/archive/expression.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <array>
#include <muParser.h>

namespace aeolis::archive {

struct Expression::State {
    mu::Parser parser;
    std::string said;                 ///< for muParser: words in place of braces
    std::vector<std::size_t> origin;  ///< position in the text of each character of `said`, and of its end
    std::vector<std::string> channels;
    std::array<double, expression_channels_max> values{};

    /// The muParser variable of a channel.
    double* variable(const std::string& channel) {
        const auto known = std::ranges::find(channels, channel);
        const auto index = static_cast<std::size_t>(known - channels.begin());
        if (known == channels.end()) {
            if (index == expression_channels_max)
                throw mu::ParserError("more than " + std::to_string(expression_channels_max) + " channels");
            channels.push_back(channel);
        }
        return &values[index];
    }
};

namespace {

Error error_at(std::size_t place, const std::string& what) {
    return {"expression, character " + std::to_string(place + 1) + ": " + what};
}

/// Whether the '=' at `at` is part of a comparison operator.
bool compares(const std::string& text, std::size_t at) {
    const auto is = [&](std::size_t i, const char* signs) {
        return i < text.size() && std::string_view(signs).find(text[i]) != std::string_view::npos;
    };
    return is(at + 1, "=") || (at > 0 && is(at - 1, "=<>!"));
}

/// Replaces names in braces, which muParser does not know, by words.
Result<void> read_braces(const std::string& text, std::string& said, std::vector<std::size_t>& origin,
                         std::vector<std::string>& quoted) {
    for (std::size_t at = 0; at < text.size(); ++at) {
        if (text[at] == '"') return error_at(at, "there are no texts in a formula");
        if (text[at] == '=' && !compares(text, at)) return error_at(at, "nothing can be assigned; a comparison is ==");
        if (text[at] == '}') return error_at(at, "'}' without '{'");
        if (text[at] != '{') {
            said += text[at];
            origin.push_back(at);
            continue;
        }
        const std::size_t end = text.find('}', at);
        if (end == std::string::npos) return error_at(at, "'{' without '}'");
        if (end == at + 1) return error_at(at, "there is no name in the braces");
        const std::string word = " __" + std::to_string(quoted.size()) + " ";
        quoted.push_back(text.substr(at + 1, end - at - 1));
        said += word;
        origin.insert(origin.end(), word.size(), at);
        at = end;
    }
    origin.push_back(text.size());
    return {};
}

}  // namespace

Expression::Expression(std::unique_ptr<State> state) : state_(std::move(state)) {}
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

Result<Expression> Expression::parse(const std::string& text) {
    if (text.size() > expression_octets_max)
        return Error{"expression: " + std::to_string(text.size()) + " octets, at most " +
                     std::to_string(expression_octets_max)};
    auto state = std::make_unique<State>();
    struct Names {
        State& state;
        std::vector<std::string> quoted;
    } names{*state, {}};
    if (auto read = read_braces(text, state->said, state->origin, names.quoted); !read) return read.error();
    try {
        const auto variable = [](const char* word, void* given) -> double* {
            auto& [of, quoted] = *static_cast<Names*>(given);
            const std::string name = word;
            if (name.starts_with("__")) {
                const std::size_t number =
                    name.find_first_not_of("0123456789", 2) == std::string::npos && name.size() > 2 && name.size() < 6
                        ? std::stoul(name.substr(2))
                        : quoted.size();
                if (number < quoted.size()) return of.variable(quoted[number]);
            }
            return of.variable(name);
        };
        state->parser.SetVarFactory(variable, &names);
        state->parser.SetExpr(state->said);
        int results = 0;
        state->parser.Eval(results);
        state->parser.SetVarFactory(nullptr, nullptr);
        if (results != 1)
            return Error{"expression: " + std::to_string(results) +
                         " values are given, one is wanted: ',' stands between arguments only"};
    } catch (const mu::ParserError& error) {
        const auto place = std::min(static_cast<std::size_t>(std::max(0, error.GetPos())), state->origin.size() - 1);
        return error_at(state->origin[place], error.GetMsg());
    }
    if (state->channels.empty()) return Error{"expression: it names no channel"};
    return Expression(std::move(state));
}

const std::vector<std::string>& Expression::channels() const {
    return state_->channels;
}

double Expression::value(std::span<const double> values) {
    AEOLIS_CHECK(values.size() == state_->channels.size());
    std::ranges::copy(values, state_->values.begin());
    return state_->parser.Eval();
}

}  // namespace aeolis::archive
