// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/procedure_reader.hpp"

#include "server/procedures/step_order.hpp"
#include "server/procedures/term_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <utility>

namespace aeolis::server::procedures {
namespace {

using Kind = YamlNode::Kind;

constexpr std::array reserved{std::string_view{"confirmation"}, std::string_view{"end"}};
constexpr unsigned revision_max = 9'999;

class ProcedureReader : public TermReader {
  public:
    /// @param procedures  none: those that a watchdog names are not looked for
    ProcedureReader(const std::string& file, const dictionary::Dictionary& dictionary,
                    std::optional<std::span<const std::string>> procedures)
        : TermReader(file, dictionary), procedures_(procedures) {}

    ReadProcedure read(std::string_view text);

  private:
    void head(const YamlNode& root, Procedure& procedure);
    std::vector<Choice> choices(const YamlNode& node);
    Target target(const YamlNode& node);
    std::vector<Position> signatures(const YamlNode& node);
    Step step(const YamlNode& node, bool of_body);
    std::vector<Step> steps(const YamlNode& root, std::string_view part, bool of_body);
    Watchdog watchdog(const YamlNode& node);
    Redline redline(const YamlNode& node, const Procedure& procedure);
    void settle_targets(std::vector<Step>& body);
    void check_order(const Procedure& procedure);

    std::optional<std::span<const std::string>> procedures_;
    /// Targets by name, until all steps are read: a number in Target::step is an index here.
    std::vector<std::pair<std::string, Mark>> named_;
};

Target ProcedureReader::target(const YamlNode& node) {
    const std::string text = words(node, "a target");
    if (text == "confirmation" || text.empty()) return {};
    if (text == "end") return {Target::Kind::end, 0};
    named_.emplace_back(text, node.mark);
    return {Target::Kind::step, named_.size() - 1};
}

std::vector<Choice> ProcedureReader::choices(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"when"}, std::string_view{"go_to"}};
    static constexpr std::array may{std::string_view{"check"}};
    std::vector<Choice> all;
    const auto items = list(&node, "'choose'", conditions_max);
    if (node.kind == Kind::sequence && items.size() < 2) add(node.mark, "a branch has two ways or more");
    all.reserve(items.size());
    for (const YamlNode& item : items) {
        if (!table(item, "a way of a branch", must, may)) continue;
        Choice& choice = all.emplace_back();
        choice.words = words(item, "when", "the words of a way");
        if (const auto same = std::ranges::find(all, choice.words, &Choice::words); &*same != &choice)
            add(item.mark, fmt::format("two ways of this branch are '{}'", choice.words));
        choice.conditions = conditions(item.member("check"));
        if (const YamlNode* go_to = item.member("go_to")) choice.target = target(*go_to);
    }
    return all;
}

std::vector<Position> ProcedureReader::signatures(const YamlNode& node) {
    std::vector<Position> all;
    const auto items = list(&node, "'sign'", positions.size());
    if (node.kind == Kind::sequence && items.empty()) add(node.mark, "'sign' is empty");
    for (const YamlNode& item : items) {
        const auto read = position(item);
        if (!read) continue;
        if (std::ranges::find(all, *read) != all.end())
            add(item.mark, fmt::format("{} signs twice", name_of(*read)));
        else
            all.push_back(*read);
    }
    return all;
}

Step ProcedureReader::step(const YamlNode& node, bool of_body) {
    static constexpr std::array must{std::string_view{"step"}, std::string_view{"who"}, std::string_view{"do"}};
    static constexpr std::array may{std::string_view{"check"},  std::string_view{"sign"}, std::string_view{"limit_s"},
                                    std::string_view{"by"},     std::string_view{"hold"}, std::string_view{"command"},
                                    std::string_view{"choose"}, std::string_view{"next"}};
    Step read;
    read.mark = node.mark;
    // A precondition or a confirmation is something to be found, in no order: it changes nothing and leads nowhere.
    constexpr std::size_t outside_body = 4;
    if (!table(node, of_body ? "a step" : "a step outside the main body", must,
               std::span{may}.first(of_body ? may.size() : outside_body)))
        return read;
    if (const YamlNode* name = node.member("step")) read.id = id(*name, "step", reserved);
    read.who = position_of(node, "who");
    read.text = words(node, "do", "the text of a step");
    read.conditions = conditions(node.member("check"));
    if (const YamlNode* sign = node.member("sign")) read.signatures = signatures(*sign);
    if (const YamlNode* limit = node.member("limit_s"))
        read.limit_s = number(*limit, "limit_s", 1.0, limit_s_max, " s");
    if (const YamlNode* by = node.member("by")) read.limit_e = entry_time(*by);
    if (!of_body) return read;
    if (const YamlNode* hold = node.member("hold")) read.hold = position(*hold);
    if (const YamlNode* prepared = node.member("command")) {
        read.command = command(*prepared);
        if (node.member("who") != nullptr && read.who != Position::command)
            add(node.member("who")->mark,
                fmt::format("a command is sent by position 'command', not by '{}'", name_of(read.who)));
    }
    if (const YamlNode* choose = node.member("choose")) {
        read.choices = choices(*choose);
        if (node.member("command") != nullptr) add(choose->mark, "a step with a command does not branch");
    }
    if (const YamlNode* next = node.member("next")) {
        if (node.member("choose") != nullptr) add(next->mark, "a branch leads on by its ways, not by 'next'");
        read.next = target(*next);
    }
    return read;
}

std::vector<Step> ProcedureReader::steps(const YamlNode& root, std::string_view part, bool of_body) {
    std::vector<Step> all;
    const YamlNode* node = root.member(part);
    const auto items = list(node, fmt::format("'{}'", part), steps_max);
    all.reserve(items.size());
    for (const YamlNode& item : items) all.push_back(step(item, of_body));
    return all;
}

Watchdog ProcedureReader::watchdog(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"watchdog"}, std::string_view{"when"}, std::string_view{"who"},
                                     std::string_view{"do"}};
    static constexpr std::array may{std::string_view{"begin"}, std::string_view{"hold"}};
    Watchdog read;
    read.mark = node.mark;
    if (!table(node, "a watchdog", must, may)) return read;
    if (const YamlNode* name = node.member("watchdog")) read.id = id(*name, "watchdog", reserved);
    read.who = position_of(node, "who");
    read.text = words(node, "do", "the text of a watchdog");
    read.conditions = conditions(node.member("when"));
    if (const YamlNode* hold = node.member("hold")) read.hold = yes_or_no(*hold, "hold").value_or(false);
    read.begin = words(node, "begin", "begin");
    if (procedures_ && !read.begin.empty() && std::ranges::find(*procedures_, read.begin) == procedures_->end())
        add(node.member("begin")->mark, unknown_name(read.begin, "procedure beside this one", *procedures_,
                                                     [](const std::string& one) -> std::string_view { return one; }));
    return read;
}

Redline ProcedureReader::redline(const YamlNode& node, const Procedure& procedure) {
    static constexpr std::array must{std::string_view{"step"}, std::string_view{"do"}, std::string_view{"reason"},
                                     std::string_view{"by"}, std::string_view{"on"}};
    static constexpr std::array may{std::string_view{"approved_by"}};
    Redline read;
    if (!table(node, "a redline", must, may)) return read;
    read.step = words(node, "step", "a step");
    read.text = words(node, "do", "the text of a redline");
    read.reason = words(node, "reason", "the reason of a redline");
    read.by = words(node, "by", "a name");
    read.on = date(node, "the day of a redline");
    read.approved_by = words(node, "approved_by", "a name");
    std::vector<std::string_view> known;
    known.reserve(3 * steps_max);
    for (const auto* part : {&procedure.preconditions, &procedure.body, &procedure.confirmation})
        for (const Step& one : *part) known.emplace_back(one.id);
    if (!read.step.empty() && std::ranges::find(known, read.step) == known.end())
        add(node.member("step")->mark, unknown_name(read.step, "step", known, std::identity{}));
    return read;
}

void ProcedureReader::settle_targets(std::vector<Step>& body) {
    const auto settle = [&](Target& target) {
        if (target.kind != Target::Kind::step) return;
        const auto& [name, mark] = named_[target.step];
        const auto found = std::ranges::find(body, name, &Step::id);
        if (found == body.end()) {
            add(mark, unknown_name(name, "step of the main body, 'confirmation' or 'end'", body,
                                   [](const Step& one) -> std::string_view { return one.id; }));
            target = {};
        } else {
            target.step = static_cast<std::size_t>(found - body.begin());
        }
    };
    for (Step& step : body) {
        if (step.next) settle(*step.next);
        for (Choice& choice : step.choices) settle(choice.target);
    }
}

void ProcedureReader::check_order(const Procedure& procedure) {
    const StepOrder order = follow(procedure.body);
    for (const std::size_t step : order.unreachable)
        add(procedure.body[step].mark, fmt::format("no way leads to step '{}'", procedure.body[step].id));
    for (const auto& circle : order.circles) {
        std::string way;
        for (const std::size_t step : circle) way += (way.empty() ? "" : " → ") + procedure.body[step].id;
        add(procedure.body[circle[circle.size() - 2]].mark, fmt::format("steps go round in a circle: {}", way));
    }
}

void ProcedureReader::head(const YamlNode& root, Procedure& procedure) {
    procedure.id = id_of_file(root, "procedure");
    procedure.title = words(root, "title", "'title'");
    procedure.purpose = words(root, "purpose", "'purpose'");
    procedure.begin_when = words(root, "begin_when", "'begin_when'");
    procedure.source = words(root, "source", "'source'");
    if (const YamlNode* revision = root.member("revision"))
        if (const auto read = number(*revision, "revision", 1.0, revision_max, "")) {
            if (*read != std::floor(*read)) add(revision->mark, "revision is no whole number");
            procedure.revision = static_cast<unsigned>(*read);
        }
    static constexpr std::array must{std::string_view{"position"}, std::string_view{"name"}, std::string_view{"on"}};
    for (const YamlNode& item : list(root.member("approved"), "'approved'", positions.size())) {
        if (!table(item, "an approval", must, {})) continue;
        const Position by = position_of(item, "position");
        procedure.approvals.push_back({by, words(item, "name", "a name"), date(item, "the day of an approval")});
    }
}

ReadProcedure ProcedureReader::read(std::string_view text) {
    static constexpr std::array must{std::string_view{"procedure"},     std::string_view{"title"},
                                     std::string_view{"revision"},      std::string_view{"purpose"},
                                     std::string_view{"begin_when"},    std::string_view{"source"},
                                     std::string_view{"preconditions"}, std::string_view{"body"},
                                     std::string_view{"watchdogs"},     std::string_view{"confirmation"}};
    static constexpr std::array may{std::string_view{"approved"}, std::string_view{"redlines"}};
    YamlDocument document = read_yaml(text, file_);
    findings_ = std::move(document.findings);
    Procedure procedure;
    if (document.root && table(*document.root, "a procedure", must, may)) {
        const YamlNode& root = *document.root;
        head(root, procedure);
        procedure.preconditions = steps(root, "preconditions", false);
        procedure.body = steps(root, "body", true);
        procedure.confirmation = steps(root, "confirmation", false);
        for (const std::string_view part : {"body", "confirmation"})
            if (const YamlNode* node = root.member(part);
                node != nullptr && node->kind == Kind::sequence && node->items.empty())
                add(node->mark, fmt::format("'{}' has no step", part));
        const auto watchdogs = list(root.member("watchdogs"), "'watchdogs'", steps_max);
        procedure.watchdogs.reserve(watchdogs.size());
        for (const YamlNode& item : watchdogs) procedure.watchdogs.push_back(watchdog(item));
        const auto redlines = list(root.member("redlines"), "'redlines'", steps_max);
        procedure.redlines.reserve(redlines.size());
        for (const YamlNode& item : redlines) procedure.redlines.push_back(redline(item, procedure));
        settle_targets(procedure.body);
        check_order(procedure);
    }
    if (findings_.empty()) return {std::move(procedure), {}};
    return {std::nullopt, all_findings()};
}

}  // namespace

ReadProcedure read_procedure(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary,
                             std::span<const std::string> procedures) {
    return ProcedureReader{file, dictionary, procedures}.read(text);
}

ReadProcedure read_procedure(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary) {
    return ProcedureReader{file, dictionary, std::nullopt}.read(text);
}

}  // namespace aeolis::server::procedures
