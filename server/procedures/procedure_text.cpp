// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/procedure_text.hpp"

#include "commands/number.hpp"
#include "server/procedures/condition.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server::procedures {
namespace {

constexpr std::size_t indent = 6;         ///< of what belongs to a step
constexpr std::size_t head_columns = 12;  ///< of a name in the head

std::size_t width_of(std::string_view text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padded(std::string_view text, std::size_t columns) {
    return std::string{text} + std::string(columns - std::min(columns, width_of(text)), ' ');
}

/// Appends a paragraph behind `first`; its further lines begin below the first one's text.
void paragraph(std::string& page, const std::string& first, std::string_view text) {
    const std::size_t margin = width_of(first);
    page += first;
    std::size_t column = margin;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find_first_of(" \n", at), text.size());
        const std::string_view word = text.substr(at, end - at);
        const bool line_ends = end < text.size() && text[end] == '\n';
        at = end + 1;
        const std::size_t width = width_of(word);
        if (width != 0) {
            if (column > margin && column + 1 + width > page_columns) {
                page += '\n' + std::string(margin, ' ');
                column = margin;
            } else if (column > margin) {
                page += ' ';
                ++column;
            }
            page += word;
            column += width;
        }
        if (line_ends && at < text.size()) {
            page += '\n' + std::string(margin, ' ');
            column = margin;
        }
    }
    page += '\n';
}

class Printer {
  public:
    Printer(const Procedure& procedure, const dictionary::Dictionary& dictionary)
        : procedure_(procedure), dictionary_(dictionary) {}

    std::string print() {
        head();
        part("PRECONDITIONS", procedure_.preconditions);
        part("MAIN BODY", procedure_.body);
        watchdogs();
        part("CONFIRMATION", procedure_.confirmation);
        redlines();
        return std::move(page_);
    }

  private:
    void line(std::string_view name, std::string_view text) {
        paragraph(page_, std::string(indent, ' ') + std::string{name} + " ", text);
    }

    void head() {
        paragraph(page_, "", procedure_.title);
        page_ += std::string(page_columns, '=') + '\n';
        const auto row = [&](std::string_view name, std::string_view text) {
            paragraph(page_, padded(name, head_columns), text);
        };
        row("procedure", fmt::format("{}, revision {}", procedure_.id, procedure_.revision));
        if (procedure_.approvals.empty()) row("approved", "by nobody: a draft");
        for (const Approval& approval : procedure_.approvals)
            row("approved", fmt::format("by {} ({}) on {}", approval.name, name_of(approval.position), approval.on));
        row("purpose", procedure_.purpose);
        row("begin when", procedure_.begin_when);
        row("source", procedure_.source);
        row("begun", "________________ by ________________");
    }

    void heading(std::string_view title) { page_ += fmt::format("\n{}\n{}\n", title, std::string(page_columns, '-')); }

    void part(std::string_view title, const std::vector<Step>& steps) {
        heading(title);
        if (steps.empty()) page_ += "none\n";
        for (const Step& one : steps) step(one);
    }

    void conditions(std::string_view name, const std::vector<Condition>& all) {
        for (const Condition& condition : all) line(name, text_of(condition, dictionary_));
    }

    void step(const Step& step) {
        page_ += fmt::format("[ ]   {}, {}\n", step.id, name_of(step.who));
        const std::string& now = text_now(procedure_, step);
        paragraph(page_, std::string(indent, ' '), now);
        if (&now != &step.text) line("REDLINED; before:", step.text);
        for (const Redline& redline : procedure_.redlines)
            if (redline.step == step.id && redline.approved_by.empty()) line("REDLINE NOT APPROVED:", redline.text);
        if (step.hold) line("HOLD until released by", fmt::format("{} ________________", name_of(*step.hold)));
        conditions("check:", step.conditions);
        if (step.command) {
            line("send:", text_of(*step.command, dictionary_));
            const auto* command = dictionary_.command(step.command->name);
            if (command != nullptr && !command->reason_for_warning.empty())
                line("warning:", command->reason_for_warning);
            line("done when:", fmt::format("the command is {}", name_of(step.command->until)));
        }
        if (step.limit_s) line("within", commands::shortest_text(*step.limit_s) + " s");
        if (step.limit_e) line("by", text_of(*step.limit_e));
        for (const Position position : step.signatures)
            line("sign:", fmt::format("{} ________________", name_of(position)));
        for (const Choice& choice : step.choices) {
            line("( )", fmt::format("{}: go to {}", choice.words, text_of(choice.target, procedure_.body)));
            for (const Condition& condition : choice.conditions) line("      if", text_of(condition, dictionary_));
        }
        if (step.next) line("then go to", text_of(*step.next, procedure_.body));
    }

    void watchdogs() {
        heading("WATCHDOGS (at any time)");
        if (procedure_.watchdogs.empty()) page_ += "none\n";
        for (const Watchdog& watchdog : procedure_.watchdogs) {
            page_ += fmt::format("[ ]   {}, {}\n", watchdog.id, name_of(watchdog.who));
            conditions("when:", watchdog.conditions);
            paragraph(page_, std::string(indent, ' '), watchdog.text);
            if (watchdog.hold) line("then", "this procedure is held");
            if (!watchdog.begin.empty()) line("begin procedure", watchdog.begin);
        }
    }

    void redlines() {
        if (procedure_.redlines.empty()) return;
        heading("REDLINES");
        for (const Redline& redline : procedure_.redlines) {
            page_ += fmt::format("step {}, by {} on {}, {}\n", redline.step, redline.by, redline.on,
                                 redline.approved_by.empty() ? "not approved" : "approved by " + redline.approved_by);
            line("now:", redline.text);
            line("because", redline.reason);
        }
    }

    const Procedure& procedure_;
    const dictionary::Dictionary& dictionary_;
    std::string page_;
};

}  // namespace

std::string printed(const Procedure& procedure, const dictionary::Dictionary& dictionary) {
    return Printer{procedure, dictionary}.print();
}

}  // namespace aeolis::server::procedures
