#pragma once
// The report and the statistics of one frame together.

#include "dermis/dermis.h"

namespace demo {

struct ReportedFrame : dermis_frame_report, dermis_frame_statistics {
  ReportedFrame()
      : dermis_frame_report DERMIS_FRAME_REPORT_INIT, dermis_frame_statistics
        DERMIS_FRAME_STATISTICS_INIT {}
  using dermis_frame_report::frame_index;
};

// Fills `out` for the newest frame up to `completed_frame_index`. Errors: as dermis_view_report.
inline dermis_result read_reported(dermis_view view, uint64_t completed_frame_index,
                                   ReportedFrame& out) {
  const dermis_result result = dermis_view_report(view, completed_frame_index, &out);
  return result == DERMIS_OK ? dermis_view_statistics(view, completed_frame_index, &out) : result;
}

} // namespace demo
