#pragma once

#include "dictionaries/xtce/document.hpp"

namespace aeolis::dictionary::xtce {

/// DefaultAlarm of a type: static ranges, of which a more severe one lies outside every less severe one, or labels of
/// an enumeration. An absent element gives no alarms.
Alarms read_alarms(pugi::xml_node default_alarm, const Type& type, Reporter& report);

} // namespace aeolis::dictionary::xtce
