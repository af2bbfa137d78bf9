// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::server::procedures {

/// A place in a text; lines and columns count from 1, columns in characters.
struct Mark {
    unsigned line = 1, column = 1;
    bool operator==(const Mark&) const = default;
};

/// A fault in a text: "start.yaml:12:7: there is no position 'captain'".
struct TextFinding {
    std::string file;
    Mark mark;
    std::string message;
    std::string text() const;
};

inline constexpr std::size_t yaml_octets_max = 256U << 10U;  ///< chosen: ten times the longest that ships
inline constexpr std::size_t yaml_nodes_max = 20'000;        ///< chosen: what such a file can hold
inline constexpr std::size_t yaml_names_max = 200;           ///< of one table; chosen: a command's arguments are 17
inline constexpr std::size_t yaml_depth_max = 12;            ///< chosen: a procedure needs 6

/// A value in YAML: a word or text, a list, or a table of named values.
struct YamlNode {
    struct Key {
        std::string name;
        Mark mark;
    };
    enum class Kind { scalar, sequence, mapping };

    Kind kind = Kind::scalar;
    Mark mark;
    std::string text{};             ///< of a scalar
    bool plain = false;             ///< a scalar without quotes: may be a number or true, and is none when empty
    std::vector<Key> keys{};        ///< of a mapping, one for each item; none twice
    std::vector<YamlNode> items{};  ///< of a sequence or mapping

    bool is_empty() const { return kind == Kind::scalar && plain && text.empty(); }
    const YamlNode* member(std::string_view name) const;
};

/// A document, or the faults for which there is none. A key that stands twice is a fault beside which the rest is read.
struct YamlDocument {
    std::optional<YamlNode> root;
    std::vector<TextFinding> findings;
};

/// Reads one YAML document of UTF-8.
///
/// Takes what a form needs: lists, tables, texts. Anchors, aliases, tags and a second document are refused, since a
/// procedure shall say what it says where it says it; so aliases of aliases cannot grow.
/// Memory  bounded by the limits above: octets before the text is read, the others while it is
YamlDocument read_yaml(std::string_view text, const std::string& file);

}  // namespace aeolis::server::procedures
