// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/parameters.hpp"

namespace aeolis::dictionary::xtce {

/// DefaultAlarm of a type: static ranges, of which a more severe one lies outside every less severe one, or labels of
/// an enumeration. An absent element gives no alarms.
/// minViolations and minConformance are samples in a row; AncillaryData "latch" with the content "true" makes the alarm
/// one that stays until it is reset.
Alarms read_alarms(pugi::xml_node default_alarm, const Type& type, Reporter& report);

/// The ContextAlarmList of each channel's type, into the channel: the context compares other channels.
void read_context_alarms(const Symbols& symbols, Parameters& parameters, Reporter& report);

}  // namespace aeolis::dictionary::xtce
