// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <initializer_list>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::dictionary::xtce {

/// A parsed XML file that knows the line of each of its elements.
class Document {
  public:
    /// None, with a finding, when the text is not XML, in an encoding that is not read, or holds no SpaceSystem.
    static std::unique_ptr<Document> parse(const std::string& in_file, Findings& findings);

    pugi::xml_node space_system() const { return xml_.child("SpaceSystem"); }
    bool holds(pugi::xml_node element) const { return element.root() == xml_; }
    unsigned line(pugi::xml_node element) const;

  private:
    void drop_prefixes();
    unsigned line_of_offset(std::ptrdiff_t offset) const;

    pugi::xml_document xml_;
    std::vector<std::ptrdiff_t> line_starts_;
};

/// Reports faults of elements, with their files and lines.
class Reporter {
  public:
    Reporter(const Document& document, Findings& findings) { add(document, findings); }
    void add(const Document& document, Findings& findings) { files_.push_back({&document, &findings}); }

    void fault(pugi::xml_node element, const std::string& message) {
        const File& file = file_of(element);
        file.findings->add(file.document->line(element), message);
    }

    /// Reports a fault at a line of the first file.
    void fault(unsigned line, const std::string& message) { files_.front().findings->add(line, message); }

    /// Reports each child and attribute not named here: unread content is never ignored silently.
    void expect(pugi::xml_node element, std::initializer_list<std::string_view> children,
                std::initializer_list<std::string_view> attributes);

    /// The attribute as a number. None when absent; none, with a finding, when it is not a number.
    std::optional<double> number(pugi::xml_node element, const char* attribute);
    /// These give `otherwise` when the attribute is absent; without `otherwise` it must be there. None, with a finding,
    /// when it is not what it should be.
    std::optional<double> number_or(pugi::xml_node element, const char* attribute, std::optional<double> otherwise);
    std::optional<std::int64_t> integer_or(pugi::xml_node element, const char* attribute,
                                           std::optional<std::int64_t> otherwise, std::int64_t min, std::int64_t max);
    std::optional<bool> flag_or(pugi::xml_node element, const char* attribute, bool otherwise);
    std::optional<std::int64_t> integer(pugi::xml_node element, const char* attribute, std::int64_t min,
                                        std::int64_t max);
    unsigned line(pugi::xml_node element) const { return file_of(element).document->line(element); }

  private:
    struct File {
        const Document* document;
        Findings* findings;
    };
    const File& file_of(pugi::xml_node element) const {
        for (const File& file : files_)
            if (file.document->holds(element)) return file;
        return files_.front();
    }

    std::vector<File> files_;
};

/// A number's text without what XML's schema lets stand around it: white space, and a sign that says nothing.
std::string_view number_digits(std::string_view word);

inline std::string name_of(pugi::xml_node element) {
    return element.attribute("name").value();
}

}  // namespace aeolis::dictionary::xtce
