// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/document.hpp"

#include "dictionaries/words.hpp"
#include "dictionaries/xtce/entities.hpp"
#include "dictionaries/xtce/text_encoding.hpp"

#include <algorithm>

namespace aeolis::dictionary::xtce {

std::unique_ptr<Document> Document::parse(const std::string& in_file, Findings& findings) {
    const auto converted = to_utf8(in_file, findings);
    if (!converted) return nullptr;
    const auto expanded = with_entities(*converted, findings);
    if (!expanded) return nullptr;
    const std::string& text = *expanded;
    auto document = std::make_unique<Document>();
    document->line_starts_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i)
        if (text[i] == '\n') document->line_starts_.push_back(static_cast<std::ptrdiff_t>(i) + 1);

    const pugi::xml_parse_result result =
        document->xml_.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
        findings.add(document->line_of_offset(result.offset),
                     std::string{"the XML does not parse: "} + result.description());
        return nullptr;
    }
    document->drop_prefixes();
    if (!document->space_system()) {
        findings.add(1, "the root element is not SpaceSystem");
        return nullptr;
    }
    return document;
}

/// Removes the prefixes that stand for XTCE: the root's, whatever it is bound to, and those bound to the same name as
/// the root's or to a name of XTCE's. Elements with other prefixes keep theirs.
void Document::drop_prefixes() {
    struct Shorten : pugi::xml_tree_walker {
        std::vector<std::string> prefixes;  // with their colon
        std::string root_space;

        void note(pugi::xml_node node) {
            for (const pugi::xml_attribute attribute : node.attributes()) {
                const std::string_view name = attribute.name(), space = attribute.value();
                constexpr std::string_view xmlns = "xmlns:";
                const bool is_xtce = space == root_space || space.find("XTCE") != std::string_view::npos ||
                                     space.find("/xtce") != std::string_view::npos;
                if (name.starts_with(xmlns) && is_xtce)
                    prefixes.push_back(std::string{name.substr(xmlns.size())} + ":");
            }
        }
        bool for_each(pugi::xml_node& node) override {
            note(node);
            const std::string_view name = node.name();
            const auto colon = name.find(':');
            if (colon == std::string_view::npos) return true;
            const bool shortened = std::ranges::find(prefixes, name.substr(0, colon + 1)) != prefixes.end();
            // A shorter name is written over the longer one in place, so that the line can still be found.
            if (shortened) node.set_name(std::string{name.substr(colon + 1)}.c_str());
            return true;
        }
    } shorten;
    const pugi::xml_node root = xml_.document_element();
    const std::string name = root.name();
    const std::string prefix = name.substr(0, name.find(':') + 1);  // empty without a colon
    if (!prefix.empty()) shorten.prefixes.push_back(prefix);
    const std::string bound = prefix.empty() ? "xmlns" : "xmlns:" + prefix.substr(0, prefix.size() - 1);
    shorten.root_space = root.attribute(bound.c_str()).value();
    xml_.traverse(shorten);
}

unsigned Document::line_of_offset(std::ptrdiff_t offset) const {
    const auto after = std::ranges::upper_bound(line_starts_, std::max<std::ptrdiff_t>(offset, 0));
    return static_cast<unsigned>(after - line_starts_.begin());
}

unsigned Document::line(pugi::xml_node element) const {
    return line_of_offset(element.offset_debug());
}

void Reporter::expect(pugi::xml_node element, std::initializer_list<std::string_view> children,
                      std::initializer_list<std::string_view> attributes) {
    const std::string parent = element.name();
    for (const pugi::xml_node child : element.children())
        if (child.type() == pugi::node_element && std::ranges::find(children, child.name()) == children.end())
            fault(child, "element " + in_quotes(child.name()) + " in " + parent + " is unknown or not supported");
    for (const pugi::xml_attribute attribute : element.attributes())
        if (!std::string_view{attribute.name()}.starts_with("xmlns") &&
            std::ranges::find(attributes, attribute.name()) == attributes.end())
            fault(element,
                  "attribute " + in_quotes(attribute.name()) + " of " + parent + " is unknown or not supported");
}

std::optional<double> Reporter::number(pugi::xml_node element, const char* attribute) {
    const pugi::xml_attribute found = element.attribute(attribute);
    if (!found) return std::nullopt;
    const auto value = to_number(found.value());
    if (!value) fault(element, std::string{attribute} + " " + in_quotes(found.value()) + " is not a number");
    return value;
}

std::optional<std::int64_t> Reporter::integer(pugi::xml_node element, const char* attribute, std::int64_t min,
                                              std::int64_t max) {
    const pugi::xml_attribute found = element.attribute(attribute);
    if (!found) return std::nullopt;
    const auto value = to_integer(found.value());
    if (value && *value >= min && *value <= max) return value;
    fault(element, std::string{attribute} + " " + in_quotes(found.value()) + " is not a whole number from " +
                       std::to_string(min) + " to " + std::to_string(max));
    return std::nullopt;
}

}  // namespace aeolis::dictionary::xtce
