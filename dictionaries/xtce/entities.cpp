// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/entities.hpp"

#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

namespace aeolis::dictionary::xtce {
namespace {

constexpr std::string_view blanks = " \t\r\n";
constexpr std::array<std::string_view, 5> predefined{"amp", "apos", "gt", "lt", "quot"};

/// The end of what begins at `at` and in which nothing refers to entities: comments, CDATA, instructions, the DTD; `at`
/// where nothing of these begins.
std::size_t end_of_unread(std::string_view text, std::size_t at) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 3> unread{
        {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}}};
    for (const auto& [begin, end] : unread)
        if (text.substr(at).starts_with(begin)) {
            const auto found = text.find(end, at + begin.size());
            return found == std::string_view::npos ? text.size() : found + end.size();
        }
    return at;
}

struct Dtd {
    std::size_t begin = 0, end = 0;  ///< where it stands
    /// Text by name; none: it is not text alone.
    std::map<std::string, std::optional<std::string>, std::less<>> entities{};
};

/// A word in quotes at or behind `at`, behind blanks only, and what follows it.
std::optional<std::pair<std::string_view, std::size_t>> quoted(std::string_view text, std::size_t at) {
    const auto open = text.find_first_not_of(blanks, at);
    if (open == std::string_view::npos || (text[open] != '"' && text[open] != '\'')) return std::nullopt;
    const auto close = text.find(text[open], open + 1);
    if (close == std::string_view::npos) return std::nullopt;
    return std::pair{text.substr(open + 1, close - open - 1), close + 1};
}

/// Reads one declaration at `at`, the first of a name as XML has it; returns where it ends.
std::size_t read_declaration(std::string_view text, std::size_t at, Dtd& into) {
    constexpr std::string_view begin = "<!ENTITY";
    if (text.substr(at).starts_with(begin)) {
        const auto name = std::min(text.find_first_not_of(blanks, at + begin.size()), text.size());
        const auto behind = std::min(text.find_first_of(blanks, name), text.size());
        const auto value = quoted(text, behind);
        const bool is_text = value && value->first.find_first_of("&<%") == std::string_view::npos;
        std::optional<std::string> words;
        if (is_text) words.emplace(value->first);
        if (words) std::ranges::replace_if(*words, [](char c) { return c == '\n' || c == '\r'; }, ' ');
        into.entities.try_emplace(std::string{text.substr(name, behind - name)}, std::move(words));
        if (value) at = value->second;
    }
    // Words in quotes may hold the end of a declaration.
    while (at < text.size() && text[at] != '>') {
        if (text[at] == '"' || text[at] == '\'') at = std::min(text.find(text[at], at + 1), text.size() - 1);
        ++at;
    }
    return std::min(at + 1, text.size());
}

Dtd read_dtd(std::string_view text, std::size_t at) {
    Dtd dtd{at, text.size()};
    const auto inside = text.find('[', at), without = text.find('>', at);
    if (inside == std::string_view::npos || without < inside) {
        dtd.end = without == std::string_view::npos ? text.size() : without + 1;
        return dtd;
    }
    for (at = inside + 1; at < text.size() && text[at] != ']';) {
        const auto end = end_of_unread(text, at);
        at = end > at ? end : text[at] == '<' ? read_declaration(text, at, dtd) : at + 1;
    }
    dtd.end = std::min(text.find('>', at), text.size());
    return dtd;
}

}  // namespace

std::optional<std::string> with_entities(std::string text, Findings& findings) {
    const std::string_view all = text;
    if (all.find('&') == std::string_view::npos) return text;
    Dtd dtd;
    std::string expanded;
    std::size_t done = 0, counted = 0;
    unsigned line = 1;
    for (std::size_t at = 0; (at = all.find_first_of("<&", at)) < all.size();) {
        line += static_cast<unsigned>(std::ranges::count(all.substr(counted, at - counted), '\n'));
        counted = at;
        auto end = end_of_unread(all, at);
        if (end == at && all.substr(at).starts_with("<!DOCTYPE")) {
            dtd = read_dtd(all, at);
            end = dtd.end;
        }
        if (end > at) {
            at = end;
            continue;
        }
        constexpr std::string_view no_name = "&;<>\"'=# \t\r\n";
        const auto close = all[at] == '&' ? all.find_first_of(no_name, at + 1) : std::string_view::npos;
        if (close == std::string_view::npos || all[close] != ';' || close == at + 1) {
            ++at;
            continue;
        }
        const std::string name{all.substr(at + 1, close - at - 1)};
        if (std::ranges::find(predefined, name) == predefined.end()) {
            const auto declared = dtd.entities.find(name);
            if (declared == dtd.entities.end()) {
                findings.add(line, "entity " + in_quotes("&" + name + ";") +
                                       " is declared nowhere in the file: it stands as it is written");
            } else if (!declared->second || expanded.size() > text.size() + entity_octets_max) {
                findings.add(line, "entity " + in_quotes("&" + name + ";") +
                                       (declared->second ? " makes the file too long"
                                                         : " is not text alone, and only such entities are read"));
                return std::nullopt;
            } else {
                expanded.append(all.substr(done, at - done)).append(*declared->second);
                done = close + 1;
            }
        }
        at = close + 1;
    }
    expanded.append(all.substr(done));
    return expanded;
}

}  // namespace aeolis::dictionary::xtce
