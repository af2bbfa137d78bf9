// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/analysis/timeline_analysis.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <string>

namespace dictionaries_timeline_analysis_test {

using namespace aeolis;
using namespace aeolis::dictionary;

namespace {

using Kind = Moment::Kind;

constexpr double tick = seconds_per_tick;

Moment anchor(std::size_t index) {
    return {Kind::anchor, static_cast<std::uint16_t>(index)};
}
Moment triggered(std::size_t index) {
    return {Kind::triggered, static_cast<std::uint16_t>(index)};
}
Moment fired(std::size_t index) {
    return {Kind::fired, static_cast<std::uint16_t>(index)};
}

AnchorRow anchor_row(std::size_t id, std::optional<AnchorId> parent, MaybeOffset offset_s) {
    return {AnchorId{static_cast<std::uint16_t>(id)}, "anchor_" + std::to_string(id), parent, offset_s, ""};
}

TimelineRow row(std::optional<AnchorId> reference, MaybeOffset desired_s, MaybeOffset minimum_s,
                std::optional<double> reply_timeout_s = {}) {
    TimelineRow made;
    made.anchor = reference;
    made.desired_offset_s = desired_s;
    made.minimum_offset_s = minimum_s;
    made.reply_timeout_s = reply_timeout_s;
    return made;
}

ConstraintRow constraint(ConstraintRow::Kind kind, Moment from, Moment to, MaybeOffset minimum_s,
                         MaybeOffset maximum_s) {
    return {kind, from, to, minimum_s, maximum_s, "test", "", 0};
}
constexpr auto required = ConstraintRow::Kind::required;
constexpr auto given = ConstraintRow::Kind::given;

Dictionary timeline_of(std::vector<AnchorRow> anchors, std::vector<TimelineRow> rows,
                       std::vector<ConstraintRow> constraints) {
    Dictionary d;
    d.anchors = std::move(anchors);
    d.timeline = std::move(rows);
    for (std::size_t i = 0; i < d.timeline.size(); ++i) {
        d.timeline[i].id = TimepointId{static_cast<std::uint16_t>(i)};
        d.timeline[i].name = "timepoint_" + std::to_string(i);
    }
    d.constraints = std::move(constraints);
    return d;
}

const std::vector<AnchorRow> root_and_entry{anchor_row(0, {}, 0.0), anchor_row(1, AnchorId{0}, {})};

double time_of(const std::vector<Instant>& schedule, const Moment& moment) {
    const auto found = std::ranges::find(schedule, moment, &Instant::moment);
    REQUIRE(found != schedule.end());
    return found->time_s;
}

bool keeps(const ConstraintRow& constraint, double difference_s) {
    return !(constraint.minimum_s && difference_s < *constraint.minimum_s) &&
           !(constraint.maximum_s && difference_s > *constraint.maximum_s);
}

/// Written anew from the words of R11, R14 and R15, not from the analysis: triggered in the first cycle in which the
/// desired offset has come, the minimum offset has, and fewer than five were triggered.
void check_schedule_is_real(const Dictionary& d, const std::vector<Instant>& schedule) {
    for (std::size_t i = 0; i < d.anchors.size(); ++i)
        if (d.anchors[i].parent && d.anchors[i].offset_s)
            CHECK(time_of(schedule, anchor(i)) ==
                  time_of(schedule, anchor(d.anchors[i].parent->value)) + *d.anchors[i].offset_s);
    for (std::size_t i = 0; i < d.timeline.size(); ++i) {
        const TimelineRow& point = d.timeline[i];
        INFO(point.name);
        const double previous_s = time_of(schedule, i == 0 ? Moment{} : fired(i - 1));
        const double triggered_s = time_of(schedule, triggered(i));
        const double base_s = point.anchor ? time_of(schedule, anchor(point.anchor->value)) : previous_s;
        CHECK(triggered_s >= previous_s);
        if (point.desired_offset_s && point.minimum_offset_s) {
            double due_s =
                std::max({previous_s, base_s + *point.desired_offset_s, previous_s + *point.minimum_offset_s});
            std::size_t in_cycle = 0;
            for (std::size_t j = 0; j < i; ++j)
                if (time_of(schedule, triggered(j)) == due_s) ++in_cycle;
            if (in_cycle == 5) due_s += tick;
            CHECK(triggered_s == due_s);
        }
        const double reply_s = time_of(schedule, fired(i)) - triggered_s;
        CHECK(reply_s >= 0.0);
        CHECK(reply_s <= point.reply_timeout_s.value_or(0.0));
    }
    for (const ConstraintRow& constraint : d.constraints)
        if (constraint.kind == given)
            CHECK(keeps(constraint, time_of(schedule, constraint.to) - time_of(schedule, constraint.from)));
}

void check_breaks_its_row(const Dictionary& d, const BoundProof& bound) {
    const ConstraintRow& broken = d.constraints[bound.constraint];
    const double difference_s = time_of(bound.schedule, broken.to) - time_of(bound.schedule, broken.from);
    if (bound.is_minimum)
        CHECK(difference_s < *broken.minimum_s);
    else
        CHECK(difference_s > *broken.maximum_s);
}

/// What adds up along the chain is the bound that it proves.
double sum_of(const std::vector<ChainStep>& chain) {
    double sum_s = 0.0;
    for (const ChainStep& step : chain) sum_s += step.at_least_s;
    return sum_s;
}

}  // namespace

TEST_CASE("the shipped timeline's explicit constraints imply every required one", "[timeline][R19][release]") {
    const Loaded loaded = load(tests::shipped_mission);
    REQUIRE(loaded.dictionary);
    const Dictionary& d = *loaded.dictionary;
    const TimelineAnalysis analysis = analyse_timeline(d);
    CHECK(analysis.all_proven());
    CHECK(analysis.bounds.size() >= 80);
    for (const BoundProof& bound : analysis.bounds) {
        INFO("constraints.csv:" << d.constraints[bound.constraint].line);
        CHECK(bound.proof == Proof::proven);
        REQUIRE(bound.slack_s);
        CHECK(*bound.slack_s >= 0.0);
        const ConstraintRow& proven = d.constraints[bound.constraint];
        CHECK(sum_of(bound.chain) - (bound.is_minimum ? *proven.minimum_s : -*proven.maximum_s) == *bound.slack_s);
        check_schedule_is_real(d, bound.schedule);  // the worst case is one that can happen
    }
}

TEST_CASE("a violation planted in the spreadsheet is found, with a schedule that keeps every explicit constraint",
          "[timeline][R19][release]") {
    struct Plant {
        const char* file;
        const char* find;
        const char* replace;
        const char* from;
        const char* to;
    };
    for (const Plant& plant : {
             // Engines light while the backshell may still be there.
             Plant{"timeline.csv", "engine_ignition,backshell,1,0,", "engine_ignition,backshell,0.75,0,",
                   "backshell_separation:fired", "engine_ignition:triggered"},
             // A slow radar switch holds up the heatshield.
             Plant{"timeline.csv", "power_on_radar,4,", "power_on_radar,15,", "heatshield:anchor",
                   "heatshield_separation:triggered"},
             // GNC no longer counts from the mortar.
             Plant{"constraints.csv", "ensured,parachute_deploy:triggered,heatshield:anchor,20,",
                   "ensured,parachute_deploy:triggered,heatshield:anchor,19.984375,", "parachute_deploy:triggered",
                   "heatshield_separation:triggered"},
         }) {
        const tests::MissionCopy mission;
        std::string text = mission.text(plant.file);
        const auto position = text.find(plant.find);
        REQUIRE(position != std::string::npos);
        text.replace(position, std::string_view{plant.find}.size(), plant.replace);
        mission.write(plant.file, text);
        const Loaded loaded = mission.load();
        INFO(plant.replace << "\n" << tests::lines_of(loaded));
        REQUIRE(loaded.dictionary);
        const Dictionary& d = *loaded.dictionary;

        const TimelineAnalysis analysis = analyse_timeline(d);
        CHECK_FALSE(analysis.all_proven());
        bool found = false;
        for (const BoundProof& bound : analysis.bounds) {
            if (bound.proof != Proof::refuted) continue;
            check_breaks_its_row(d, bound);
            check_schedule_is_real(d, bound.schedule);
            const ConstraintRow& broken = d.constraints[bound.constraint];
            found = found || (moment_text(d, broken.from) == plant.from && moment_text(d, broken.to) == plant.to);
        }
        CHECK(found);
    }
}

TEST_CASE("what GNC triggers waits for no row that GNC does not need, however early it comes",
          "[timeline][R19][release]") {
    const Dictionary& d = tests::shipped_dictionary();
    const TimelineAnalysis analysis = analyse_timeline(d);
    std::set<std::string> triggered;
    for (const HoldProof& hold : analysis.holds) {
        INFO(d.timeline[hold.triggered.value].name << " after " << d.timeline[hold.before.value].name);
        CHECK(hold.proof == Proof::proven);
        CHECK_FALSE(d.timeline[hold.before.value].essential);
        triggered.insert(d.timeline[hold.triggered.value].name);
    }
    CHECK(triggered == std::set<std::string>{"entry_guidance", "sufr", "parachute_deploy", "heatshield_separation",
                                             "engine_priming", "backshell_separation", "powered_approach", "sky_crane",
                                             "rover_separation", "touchdown"});
}

TEST_CASE("a row that is only said, or serves only the radio, is found where it can hold what GNC triggers",
          "[timeline][R19][release]") {
    struct Plant {
        const char* before;  ///< the row that it is put in front of
        const char* row;
        const char* name;
        const char* holds;
    };
    for (const Plant& plant : {
             Plant{"engine_priming,", "beat,heatshield,30,0,,undefined,,,,no,no,entry_interface,,Only a tone\n", "beat",
                   "engine_priming"},
             Plant{"parachute_deploy,", "beat,sufr_start,8,0,select_parachute_antenna,2,done,,,no,no,,,For the radio\n",
                   "beat", "parachute_deploy"},
             // Due at once, but it waits for a reply.
             Plant{"sufr,", "beat,guidance_start,0,0,select_parachute_antenna,2,done,,,no,no,,,For the radio\n", "beat",
                   "sufr"},
         }) {
        const tests::MissionCopy mission;
        std::string text = mission.text("timeline.csv");
        const auto position = text.find(std::string{"\n"} + plant.before);
        REQUIRE(position != std::string::npos);
        mission.write("timeline.csv", text.insert(position + 1, plant.row));
        const Loaded loaded = mission.load();
        INFO(plant.row << tests::lines_of(loaded));
        REQUIRE(loaded.dictionary);
        const Dictionary& d = *loaded.dictionary;

        const TimelineAnalysis analysis = analyse_timeline(d);
        CHECK_FALSE(analysis.all_proven());
        bool found = false;
        for (const HoldProof& hold : analysis.holds) {
            if (hold.proof == Proof::proven) continue;
            REQUIRE(hold.proof == Proof::refuted);
            CHECK(d.timeline[hold.before.value].name == plant.name);
            const Moment trigger = anchor(d.timeline[hold.triggered.value].anchor->value);
            CHECK(time_of(hold.schedule, fired(hold.before.value)) > time_of(hold.schedule, trigger));
            found |= d.timeline[hold.triggered.value].name == plant.holds;
        }
        CHECK(found);
    }
}

TEST_CASE("a reply that may take until its time-out is an interval", "[timeline][R19]") {
    const auto analysed = [](double minimum_s) {
        return analyse_timeline(timeline_of(root_and_entry,
                                            {row(AnchorId{1}, 0.0, 0.0, 2.0), row(AnchorId{1}, 5.0, 1.0)},
                                            {constraint(given, {}, anchor(1), 10.0, {}),
                                             constraint(required, fired(0), triggered(1), minimum_s, 5.0)}));
    };
    const auto proven = analysed(3.0);
    CHECK(proven.all_proven());
    REQUIRE(proven.bounds.size() == 2);
    CHECK(proven.bounds[0].slack_s == 0.0);
    CHECK(proven.bounds[1].slack_s == 0.0);
    const auto refuted = analysed(3.0 + tick);
    CHECK(refuted.bounds[0].proof == Proof::refuted);
    CHECK(refuted.bounds[0].slack_s == -tick);
}

TEST_CASE("an anchor that may be set at any time bounds nothing, until a given row says when", "[timeline][R19]") {
    std::vector<AnchorRow> anchors = root_and_entry;
    anchors.push_back(anchor_row(2, AnchorId{0}, {}));
    const std::vector<TimelineRow> rows{row(AnchorId{1}, 0.0, 0.0), row(AnchorId{2}, 0.0, 0.5)};
    const auto claim = constraint(required, fired(0), triggered(1), 0.5, 20.0);
    const auto free = analyse_timeline(timeline_of(anchors, rows, {claim}));
    CHECK(free.bounds[0].proof == Proof::proven);
    CHECK(free.bounds[1].proof == Proof::refuted);
    CHECK_FALSE(free.bounds[1].slack_s);
    CHECK(free.bounds[1].chain.empty());
    const auto held =
        analyse_timeline(timeline_of(anchors, rows, {claim, constraint(given, anchor(1), anchor(2), {}, 20.0)}));
    CHECK(held.all_proven());
}

TEST_CASE("the sixth timepoint of a cycle comes a cycle later", "[timeline][R15][R19]") {
    const std::vector<TimelineRow> rows(7, row({}, 0.0, 0.0));
    const auto analysis = analyse_timeline(timeline_of(root_and_entry, rows,
                                                       {constraint(required, triggered(0), triggered(4), {}, 0.0),
                                                        constraint(required, triggered(0), triggered(5), tick, tick),
                                                        constraint(required, triggered(0), triggered(6), {}, 0.0)}));
    CHECK(analysis.bounds[0].proof == Proof::proven);
    CHECK(analysis.bounds[1].proof == Proof::proven);
    CHECK(analysis.bounds[2].proof == Proof::proven);
    CHECK(analysis.bounds[3].proof == Proof::refuted);
}

TEST_CASE("a timepoint with an undefined offset may fire at any time after its predecessor", "[timeline][R13][R19]") {
    const auto analysis =
        analyse_timeline(timeline_of(root_and_entry, {row({}, 1.0, 0.0), row({}, {}, 0.0), row({}, 1.0, 0.0)},
                                     {constraint(required, fired(0), triggered(2), 1.0, 100.0)}));
    CHECK(analysis.bounds[0].proof == Proof::proven);
    CHECK(analysis.bounds[1].proof == Proof::refuted);
}

TEST_CASE("an analysis ends when it is asked to, says so, and proves nothing that it has not looked at",
          "[timeline][R19][release]") {
    unsigned asked = 0;
    const auto whole = analyse_timeline(tests::shipped_dictionary(), [&asked] { return ++asked == 0; });
    CHECK_FALSE(whole.stopped);
    const auto bounds = analyse_bounds(tests::shipped_dictionary());
    CHECK(bounds.all_proven());
    CHECK(bounds.bounds.size() == whole.bounds.size());
    CHECK(bounds.margins.empty());
    CHECK(whole.all_proven());
    CHECK(asked > whole.bounds.size());
    const auto cut = analyse_timeline(tests::shipped_dictionary(), [] { return true; });
    CHECK(cut.stopped);
    CHECK_FALSE(cut.all_proven());
}

TEST_CASE("given rows that contradict the timeline prove nothing", "[timeline][R19]") {
    // Among themselves: a ring says why.
    const std::vector<TimelineRow> rows{row(AnchorId{1}, 0.0, 0.0), row({}, 2.0, 0.0)};
    const auto claim = constraint(required, fired(0), triggered(1), 100.0, {});
    const auto ring = analyse_timeline(timeline_of(
        root_and_entry, rows,
        {claim, constraint(given, triggered(1), anchor(1), 0.0, {}), constraint(given, {}, anchor(1), 1.0, {})}));
    CHECK_FALSE(ring.all_proven());
    REQUIRE_FALSE(ring.contradiction.empty());
    CHECK(sum_of(ring.contradiction) > 0.0);
    // With "as soon as": each bound alone could be kept, were the second timepoint late.
    std::vector<AnchorRow> anchors = root_and_entry;
    anchors.push_back(anchor_row(2, AnchorId{0}, {}));
    const auto late = analyse_timeline(timeline_of(anchors, rows,
                                                   {claim, constraint(given, fired(0), anchor(2), 5.0, 5.0),
                                                    constraint(given, triggered(1), anchor(2), {}, 1.0)}));
    CHECK_FALSE(late.all_proven());
    CHECK(late.contradiction.empty());
    CHECK_FALSE(late.admits_schedule);
}

namespace {

/// Every schedule of a small timeline: all times of the anchors, all replies, by trying. In ticks.
class BruteForce {
  public:
    BruteForce(const Dictionary& d, int first, int last) : d_(d), first_(first), last_(last) {}

    /// Least and greatest of to - from; none when no schedule keeps the given rows.
    struct Range {
        int least = std::numeric_limits<int>::max();
        int greatest = std::numeric_limits<int>::min();
    };
    Range range(const Moment& from, const Moment& to) {
        from_ = from;
        to_ = to;
        range_ = {};
        anchors_.assign(d_.anchors.size(), 0);
        triggered_.assign(d_.timeline.size(), 0);
        fired_ = triggered_;
        set_anchor(1);
        return range_;
    }

  private:
    static int ticks(double offset_s) { return static_cast<int>(offset_s * 64.0); }

    void set_anchor(std::size_t index) {
        if (index == anchors_.size()) return fire(0);
        const AnchorRow& row = d_.anchors[index];
        const bool is_fixed = row.offset_s.has_value();
        const int fixed = is_fixed ? anchors_[row.parent->value] + ticks(*row.offset_s) : 0;
        for (int t = is_fixed ? fixed : first_; t <= (is_fixed ? fixed : last_); ++t) {
            anchors_[index] = t;
            set_anchor(index + 1);
        }
    }

    void fire(std::size_t index) {
        if (index == triggered_.size()) return finish();
        const TimelineRow& row = d_.timeline[index];
        const int previous = index == 0 ? 0 : fired_[index - 1];
        const int base = row.anchor ? anchors_[row.anchor->value] : previous;
        const int due =
            std::max({previous, base + ticks(*row.desired_offset_s), previous + ticks(*row.minimum_offset_s)});
        triggered_[index] = due;  // never six: there are not so many
        for (int reply = 0; reply <= ticks(row.reply_timeout_s.value_or(0.0)); ++reply) {
            fired_[index] = due + reply;
            fire(index + 1);
        }
    }

    int time(const Moment& moment) const {
        switch (moment.kind) {
        case Kind::do_edl: return 0;
        case Kind::anchor: return anchors_[moment.index];
        case Kind::triggered: return triggered_[moment.index];
        case Kind::fired: return fired_[moment.index];
        }
        return 0;
    }

    void finish() {
        for (const ConstraintRow& row : d_.constraints)
            if (row.kind == given && !keeps(row, (time(row.to) - time(row.from)) * tick)) return;
        const int difference = time(to_) - time(from_);
        range_.least = std::min(range_.least, difference);
        range_.greatest = std::max(range_.greatest, difference);
    }

    const Dictionary& d_;
    int first_, last_;
    Moment from_, to_;
    Range range_;
    std::vector<int> anchors_, triggered_, fired_;
};

/// Root, one free anchor, one more that is fixed to it or free and given; three or four timepoints. All within reach.
Dictionary random_timeline(std::mt19937& random) {
    const auto up_to = [&](unsigned limit) { return static_cast<double>(random() % (limit + 1)) * tick; };
    std::vector<AnchorRow> anchors = root_and_entry;
    const bool is_fixed = random() % 2 == 0;
    anchors.push_back(anchor_row(2, AnchorId{1}, is_fixed ? MaybeOffset{up_to(4)} : MaybeOffset{}));
    std::vector<TimelineRow> rows;
    const std::size_t count = 3 + random() % 2;
    for (std::size_t i = 0; i < count; ++i) {
        const unsigned reference = random() % 3;
        rows.push_back(row(
            reference == 0 ? std::nullopt : std::optional{AnchorId{static_cast<std::uint16_t>(reference)}},
            up_to(5) - 2 * tick, up_to(3) - tick, random() % 2 == 0 ? std::nullopt : std::optional{tick + up_to(2)}));
    }
    // Everything is bounded, so that what is tried is all that there is.
    std::vector<ConstraintRow> constraints{constraint(given, {}, anchor(1), -2 * tick, 5 * tick)};
    if (!is_fixed) {
        const auto from = random() % 2 == 0 ? triggered(random() % 2) : fired(random() % 2);
        const double minimum_s = up_to(3) - 2 * tick;
        constraints.push_back(constraint(given, from, anchor(2), minimum_s, minimum_s + up_to(4)));
    }
    const auto moment = [&]() -> Moment {
        const auto index = random() % count;
        const unsigned kind = random() % 6;
        return kind == 0 ? anchor(1 + random() % 2) : kind == 1 ? Moment{} : kind < 4 ? triggered(index) : fired(index);
    };
    const Moment from = moment();
    Moment to = moment();
    while (to == from) to = moment();
    constraints.push_back(constraint(required, from, to, up_to(8) - 4 * tick, up_to(12)));
    return timeline_of(std::move(anchors), std::move(rows), std::move(constraints));
}

}  // namespace

TEST_CASE("on small random timelines the analysis agrees with trying every schedule", "[timeline][R19]") {
    std::mt19937 random{20120806};
    std::size_t proven = 0;
    std::size_t refuted = 0;
    std::size_t impossible = 0;
    std::size_t unbounded = 0;
    for (int trial = 0; trial < 1500; ++trial) {
        const Dictionary d = random_timeline(random);
        INFO("trial " << trial);
        const ConstraintRow& claim = d.constraints.back();
        const auto tried = BruteForce{d, -5, 30}.range(claim.from, claim.to);
        const TimelineAnalysis analysis = analyse_timeline(d);
        const bool possible = tried.least <= tried.greatest;
        CHECK((analysis.contradiction.empty() && analysis.admits_schedule) == possible);
        if (!possible) {
            ++impossible;
            continue;
        }
        REQUIRE(analysis.bounds.size() == 2);
        const double tried_slack_s[] = {tried.least * tick - *claim.minimum_s,
                                        *claim.maximum_s - tried.greatest * tick};
        for (const BoundProof& bound : analysis.bounds) {
            // An anchor that follows what hangs on it has no last time: then what is tried ends, and the slack does
            // not.
            if (bound.slack_s) CHECK(*bound.slack_s == tried_slack_s[bound.is_minimum ? 0 : 1]);
            CHECK((bound.proof == Proof::proven) == (bound.slack_s && *bound.slack_s >= 0.0));
            if (!bound.slack_s) ++unbounded;
            CHECK(bound.proof != Proof::undecided);
            check_schedule_is_real(d, bound.schedule);
            if (bound.proof == Proof::refuted) check_breaks_its_row(d, bound);
            ++(bound.proof == Proof::refuted ? refuted : proven);
        }
    }
    // The trials try all that there is to try.
    CHECK(proven > 500);
    CHECK(refuted > 500);
    CHECK(impossible > 20);
    CHECK(unbounded < 300);
}

}  // namespace dictionaries_timeline_analysis_test
