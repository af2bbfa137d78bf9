// SPDX-License-Identifier: Apache-2.0
#include "telemetry/text_kernel.hpp"

#include "common/calendar.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

namespace aeolis::telemetry {
namespace {

constexpr std::string_view blanks = " \t\r\n\f\v";

/// Reads a number in FORTRAN's notation: "1.657D-3", "+10", ".5".
std::optional<double> kernel_number(std::string_view word) {
    std::string text{word.starts_with('+') ? word.substr(1) : word};
    std::ranges::replace_if(text, [](char c) { return c == 'D' || c == 'd'; }, 'e');
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (text.empty() || error != std::errc{} || stopped != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<unsigned> month_of(std::string_view word) {
    constexpr std::array<std::string_view, 12> names{"JAN", "FEB", "MAR", "APR", "MAY", "JUN",
                                                     "JUL", "AUG", "SEP", "OCT", "NOV", "DEC"};
    std::string upper{word.substr(0, 3)};
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const auto* const found = std::ranges::find(names, upper);
    if (found == names.end()) return std::nullopt;
    return static_cast<unsigned>(found - names.begin()) + 1;
}

/// Reads a date: "1972-JAN-1", "01-JAN-1980-00:00:00.0", "2012-08-06/05:17:57", "2012-219T05:17".
std::optional<double> kernel_date(std::string_view word) {
    std::vector<std::string_view> parts;
    std::size_t date_parts = 0;  // those before a separator that only a time of day follows
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= word.size(); ++i) {
        const bool digit_before = i > 0 && std::isdigit(static_cast<unsigned char>(word[i - 1])) != 0;
        const bool ends_date = i < word.size() && (word[i] == '/' || (word[i] == 'T' && digit_before));
        if (i < word.size() && word[i] != '-' && word[i] != ':' && !ends_date) continue;
        parts.push_back(word.substr(begin, i - begin));
        if (ends_date && date_parts == 0) date_parts = parts.size();
        begin = i + 1;
    }
    const bool named = parts.size() >= 3 && month_of(parts[1]);
    if (date_parts == 0) date_parts = named ? 3 : std::min<std::size_t>(parts.size(), 3);
    if (date_parts < 2 || date_parts > 3 || parts.size() > date_parts + 3) return std::nullopt;
    std::vector<double> numbers;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (named && i == 1) {
            numbers.push_back(*month_of(parts[1]));
            continue;
        }
        const auto number = kernel_number(parts[i]);
        const bool seconds = i == date_parts + 2;
        if (!number || *number < 0.0 || *number > 9999.0 || (!seconds && *number != std::floor(*number)))
            return std::nullopt;
        numbers.push_back(*number);
    }
    if (named && parts[2].size() > parts[0].size()) std::swap(numbers[0], numbers[2]);  // 1-JAN-1980
    const int year = static_cast<int>(numbers[0]);
    const bool of_year = date_parts == 2;
    auto day = days_since_2000(year, of_year ? 1 : static_cast<unsigned>(numbers[1]),
                               of_year ? 1 : static_cast<unsigned>(numbers[2]));
    if (!day || (of_year && (numbers[1] < 1 || numbers[1] > 366))) return std::nullopt;
    if (of_year) *day += static_cast<std::int64_t>(numbers[1]) - 1;
    numbers.resize(date_parts + 3, 0.0);
    return static_cast<double>(*day) * 86400.0 - 43200.0 + numbers[date_parts] * 3600.0 +
           numbers[date_parts + 1] * 60.0 + numbers[date_parts + 2];
}

/// A word of the data sections: name, =, +=, (, ), number, date, 'text'.
struct Word {
    std::string text;
    unsigned line = 0;
    bool quoted = false;
};

std::string_view trimmed_line(std::string_view line) {
    const auto first = line.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return line.substr(first, line.find_last_not_of(blanks) - first + 1);
}

/// Splits a line into words. Returns false when a text does not end in its line.
bool words_of_line(std::string_view line, unsigned number, std::vector<Word>& into) {
    for (std::size_t i = line.find_first_not_of(blanks); i < line.size();) {
        if (line[i] == '\'') {
            Word word{{}, number, true};
            for (++i;; ++i) {
                if (i >= line.size()) return false;
                if (line[i] != '\'') {
                    word.text += line[i];
                } else if (i + 1 < line.size() && line[i + 1] == '\'') {
                    word.text += line[i++];
                } else {
                    break;
                }
            }
            into.push_back(std::move(word));
            ++i;
        } else if (line[i] == '(' || line[i] == ')' || line[i] == '=') {
            into.push_back({std::string{line[i++]}, number, false});
        } else if (line.substr(i, 2) == "+=") {
            into.push_back({"+=", number, false});
            i += 2;
        } else if (line[i] == ',' || blanks.find(line[i]) != std::string_view::npos) {
            ++i;
        } else {
            std::size_t end = line.find_first_of(" \t\r\n\f\v,()='", i);
            end = std::min(end, line.size());
            if (end < line.size() && line[end] == '=' && line[end - 1] == '+' && end - 1 > i) --end;
            into.push_back({std::string{line.substr(i, end - i)}, number, false});
            i = end;
        }
    }
    return true;
}

Error fault_at(const std::string& file, unsigned line, const std::string& what) {
    return Error{file + ":" + std::to_string(line) + ": " + what};
}

Result<std::vector<Word>> words_of(std::string_view text, const std::string& file) {
    std::vector<Word> words;
    bool data = false;
    unsigned number = 0;
    bool any = false;
    while (!text.empty()) {
        const auto end = text.find('\n');
        const auto line = trimmed_line(text.substr(0, end));
        text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
        ++number;
        if (line == "\\begindata" || line == "\\begintext") {
            data = line == "\\begindata";
            any = any || data;
        } else if (data && !words_of_line(line, number, words)) {
            return fault_at(file, number, "a text that begins with ' does not end in its line");
        } else if (words.size() > 2 * TextKernel::values_max) {
            return fault_at(file, number,
                            "there is more in it than " + std::to_string(TextKernel::values_max) + " values");
        }
    }
    if (!any) return fault_at(file, 1, "it has no line \\begindata: it is no text kernel");
    return words;
}

Result<TextKernel::Value> value_of_word(const Word& word, const std::string& file) {
    if (word.quoted) return TextKernel::Value{word.text};
    const auto number =
        word.text.starts_with('@') ? kernel_date(std::string_view{word.text}.substr(1)) : kernel_number(word.text);
    if (number) return TextKernel::Value{*number};
    return fault_at(file, word.line, "'" + word.text + "' is neither a number, a date behind @ nor a text in quotes");
}

}  // namespace

Result<TextKernel> TextKernel::parse(std::string_view text, const std::string& file) {
    const auto words = words_of(text, file);
    if (!words) return words.error();
    TextKernel kernel;
    kernel.file_ = file;
    std::size_t values = 0;
    const auto is = [](const Word& word, std::string_view sign) { return !word.quoted && word.text == sign; };
    for (auto word = words->begin(); word != words->end();) {
        const Word& name = *word++;
        if (name.quoted || name.text.find_first_of("()=") != std::string::npos)
            return fault_at(file, name.line, "a name is wanted where '" + name.text + "' stands");
        const bool adds = word != words->end() && is(*word, "+=");
        if (word == words->end() || (!adds && !is(*word, "=")))
            return fault_at(file, name.line, "there is no = behind '" + name.text + "'");
        ++word;
        Variable& variable = kernel.variables_[name.text];
        if (!adds) variable.values.clear();
        variable.line = name.line;
        const bool list = word != words->end() && is(*word, "(");
        if (list) ++word;
        const std::size_t before = variable.values.size();
        while (word != words->end() && !is(*word, ")")) {
            auto value = value_of_word(*word, file);
            if (!value) return value.error();
            if (++values > values_max)
                return fault_at(file, word->line, "there are more than " + std::to_string(values_max) + " values");
            variable.values.push_back(std::move(*value));
            ++word;
            if (!list) break;
        }
        if (list && word == words->end())
            return fault_at(file, name.line, "the ( of '" + name.text + "' is never closed");
        if (list) ++word;
        if (variable.values.size() == before) return fault_at(file, name.line, "'" + name.text + "' has no value");
    }
    return kernel;
}

const TextKernel::Variable* TextKernel::find(const std::string& name) const {
    const auto found = variables_.find(name);
    return found == variables_.end() ? nullptr : &found->second;
}

Result<std::vector<double>> TextKernel::numbers(const std::string& name, std::size_t least) const {
    const Variable* variable = find(name);
    if (variable == nullptr) return Error{file_ + ": it says no " + name};
    std::vector<double> numbers;
    for (const Value& value : variable->values) {
        const auto* number = std::get_if<double>(&value);
        if (number == nullptr) return fault_at(file_, variable->line, name + " is a text where a number is wanted");
        numbers.push_back(*number);
    }
    if (numbers.size() < least)
        return fault_at(file_, variable->line,
                        name + " has " + std::to_string(numbers.size()) + " values where " + std::to_string(least) +
                            " are wanted");
    return numbers;
}

}  // namespace aeolis::telemetry
