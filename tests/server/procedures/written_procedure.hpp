// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/procedures/procedure_reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace aeolis::tests {

/// The least text of a procedure, the parts of which a test replaces.
struct WrittenProcedure {
    std::string head = "procedure: p\ntitle: T\nrevision: 1\npurpose: P\nbegin_when: B\nsource: S\n";  // lines 1 to 6
    std::string preconditions = "preconditions: []\n";                                                 // line 7
    std::string body = "body:\n  - {step: a, who: gnc, do: A}\n";                                      // lines 8, 9
    std::string confirmation = "confirmation:\n  - {step: z, who: gnc, do: Z}\n";                      // lines 10, 11
    std::string watchdogs = "watchdogs: []\n";                                                         // line 12
    std::string rest{};

    std::string text() const { return head + preconditions + body + confirmation + watchdogs + rest; }
};

inline const std::vector<std::string>& other_procedures() {
    static const std::vector<std::string> names{"p", "other"};
    return names;
}

/// The line `number` of a text, from 1.
inline std::string line_of(const std::string& text, unsigned number) {
    std::istringstream lines{text};
    std::string line;
    for (unsigned i = 0; i < number; ++i) std::getline(lines, line);
    return line;
}

/// What reading finds, a line each; empty when nothing is wrong.
inline std::string findings_of(const std::string& text) {
    const auto read = server::procedures::read_procedure(text, "p.yaml", shipped_dictionary(), other_procedures());
    std::string all;
    for (const auto& finding : read.findings) {
        all += finding.text() + "\n";
        // An unknown name is found where it stands.
        if (const auto end = finding.message.find("' is no ");
            finding.message.starts_with('\'') && end != std::string::npos)
            CHECK(line_of(text, finding.mark.line)
                      .substr(finding.mark.column - 1)
                      .starts_with(finding.message.substr(1, end - 1)));
    }
    CHECK(read.procedure.has_value() == read.findings.empty());
    return all;
}
inline std::string findings_of(const WrittenProcedure& written) {
    return findings_of(written.text());
}

inline server::procedures::Procedure procedure_of(const WrittenProcedure& written) {
    const auto read =
        server::procedures::read_procedure(written.text(), "p.yaml", shipped_dictionary(), other_procedures());
    for (const auto& finding : read.findings) UNSCOPED_INFO(finding.text());
    REQUIRE(read.procedure);
    return *read.procedure;
}

inline std::shared_ptr<const server::procedures::Procedure> shared_procedure(const WrittenProcedure& written) {
    return std::make_shared<const server::procedures::Procedure>(procedure_of(written));
}

}  // namespace aeolis::tests
