// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/text_encoding.hpp"

#include "dictionaries/xtce/characters.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <span>
#include <vector>

namespace aeolis::dictionary::xtce {
namespace {

using namespace std::string_view_literals;
using Characters = Coding::Characters;

constexpr std::size_t declaration_octets_max = 512;  // chosen: declarations take about 60

/// How a text is written, as its first octets show.
struct Written {
    std::string_view begins;
    Characters characters;
    std::size_t mark_octets;  ///< of its byte order mark
    std::string_view name;    ///< empty: one octet or more a character, the declaration says which
    bool read = true;
};

// The longer ones first: UTF-32's mark begins like that of UTF-16.
constexpr std::array written_forms{
    Written{"\xFF\xFE\0\0"sv, Characters::utf8, 4, "UTF-32", false},
    Written{"\0\0\xFE\xFF"sv, Characters::utf8, 4, "UTF-32", false},
    Written{"<\0\0\0"sv, Characters::utf8, 0, "UTF-32", false},
    Written{"\0\0\0<"sv, Characters::utf8, 0, "UTF-32", false},
    Written{"\xEF\xBB\xBF"sv, Characters::utf8, 3, "UTF-8"},
    Written{"\xFF\xFE"sv, Characters::utf16_little_endian, 2, "UTF-16"},
    Written{"\xFE\xFF"sv, Characters::utf16_big_endian, 2, "UTF-16"},
    Written{"<\0"sv, Characters::utf16_little_endian, 0, "UTF-16"},
    Written{"\0<"sv, Characters::utf16_big_endian, 0, "UTF-16"},
    Written{"Lo\xA7\x94"sv, Characters::utf8, 0, "EBCDIC", false},
};

std::span<const std::uint8_t> octets_of(std::string_view text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// The encoding that the declaration names, in capitals; empty without one.
std::string declared_encoding(std::string_view text) {
    if (!text.starts_with("<?xml")) return {};
    std::string_view declaration = text.substr(0, declaration_octets_max);
    declaration = declaration.substr(0, declaration.find("?>"));
    const auto at = declaration.find("encoding");
    if (at == std::string_view::npos) return {};
    const auto open = declaration.find_first_of("'\"", at);
    if (open == std::string_view::npos) return {};
    const auto close = declaration.find(declaration[open], open + 1);
    std::string name{declaration.substr(open + 1, close - open - 1)};
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return name;
}

unsigned line_at(std::string_view text, std::size_t offset) {
    return static_cast<unsigned>(std::ranges::count(text.substr(0, offset), '\n')) + 1;
}

/// The first line whose octets are no characters; 0: there is none.
unsigned line_of_no_characters(std::string_view text, bool ascii) {
    unsigned line = 0;
    for (std::size_t at = 0; at <= text.size();) {
        const auto end = std::min(text.find('\n', at), text.size());
        const auto octets = octets_of(text.substr(at, end - at));
        ++line;
        const bool all_ascii = std::ranges::all_of(octets, [](std::uint8_t octet) { return octet < 0x80; });
        if (!all_ascii && (ascii || !text_of(octets, Characters::utf8))) return line;
        at = end + 1;
    }
    return 0;
}

/// Whether "#233" or "#xE9" stands for a character of XML. [xml-1.0] 2.2
bool is_reference_to_character(std::string_view reference) {
    reference.remove_prefix(1);
    const bool hexadecimal = reference.starts_with('x');
    if (hexadecimal) reference.remove_prefix(1);
    unsigned code = 0;
    const auto [end, error] =
        std::from_chars(reference.data(), reference.data() + reference.size(), code, hexadecimal ? 16 : 10);
    if (error != std::errc{} || end != reference.data() + reference.size()) return false;
    return code == 0x9 || code == 0xA || code == 0xD || (code >= 0x20 && code < 0xD800) ||
           (code >= 0xE000 && code <= 0xFFFD) || (code >= 0x10000 && code <= 0x10FFFF);
}

bool references_are_characters(std::string_view text, Findings& findings) {
    for (std::size_t at = text.find("&#"); at != std::string_view::npos; at = text.find("&#", at + 2)) {
        const auto end = text.find(';', at);
        const std::string_view reference = text.substr(at + 1, end == std::string_view::npos ? end : end - at - 1);
        if (is_reference_to_character(reference)) continue;
        findings.add(line_at(text, at),
                     "the reference " + in_quotes("&" + std::string{reference.substr(0, 16)}) + " is no character");
        return false;
    }
    return true;
}

}  // namespace

std::optional<std::string> to_utf8(std::string_view text, Findings& findings) {
    const auto refuse = [&](unsigned line, const std::string& words) {
        findings.add(line, words);
        return std::nullopt;
    };
    const auto* const form =
        std::ranges::find_if(written_forms, [&](const Written& written) { return text.starts_with(written.begins); });
    const bool told = form != written_forms.end();
    if (told && !form->read)
        return refuse(1, "the file is written in " + std::string{form->name} +
                             ", which is not read: UTF-8, US-ASCII, ISO-8859-1 and UTF-16 are");
    if (told) text.remove_prefix(form->mark_octets);
    const Characters characters = told ? form->characters : Characters::utf8;
    std::string converted;
    if (characters != Characters::utf8) {
        auto from_utf16 = text_of(octets_of(text), characters);
        if (!from_utf16) return refuse(1, "the file begins as UTF-16, and is not UTF-16 to its end");
        converted = std::move(*from_utf16);
        text = converted;
    }
    const std::string declared = declared_encoding(text);
    const bool utf16 = declared.starts_with("UTF-16"), ascii = declared == "US-ASCII" || declared == "ASCII";
    const bool latin1 = declared == "ISO-8859-1" || declared == "ISO_8859-1" || declared == "LATIN1";
    if (!declared.empty() && !utf16 && !ascii && !latin1 && declared != "UTF-8" && declared != "UTF8")
        return refuse(1,
                      "encoding " + in_quotes(declared) + " is not read: UTF-8, US-ASCII, ISO-8859-1 and UTF-16 are");
    const bool little = declared == "UTF-16LE", big = declared == "UTF-16BE";
    const bool differs = told ? !declared.empty() && (form->name == "UTF-16" ? !utf16 : utf16 || latin1) : utf16;
    if (differs || (little && characters == Characters::utf16_big_endian) ||
        (big && characters == Characters::utf16_little_endian))
        return refuse(1, "the file declares " + in_quotes(declared) + " and is not written in it");
    if (!references_are_characters(text, findings)) return std::nullopt;
    if (latin1) return text_of(octets_of(text), Characters::latin1);
    if (const unsigned line = converted.empty() ? line_of_no_characters(text, ascii) : 0; line != 0)
        return refuse(line, "octets that are no characters in " + (declared.empty() ? "UTF-8" : declared) +
                                ": the declaration of the file names another encoding, or none, than it is written in");
    return std::string{text};
}

}  // namespace aeolis::dictionary::xtce
