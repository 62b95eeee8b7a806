/* Dermis: the choice by budget. Included by dermis/dermis.h, whose conventions for structs, errors,
 * threads and costs apply.
 *
 * A graph may leave settings to the library ("by": "budget"). A configuration is one combination of
 * their options. The host gives a budget of device time (dermis_graph_set_budget) and of memory
 * (dermis_graph_desc.max_bytes); each record runs the configuration with the least expected error
 * that fits both. docs/choice.md describes how times and errors are known.
 */
#ifndef DERMIS_CHOICE_H
#define DERMIS_CHOICE_H

#include "dermis.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DERMIS_BUDGET_DETERMINISTIC 0x1u /* no timestamps: equal calibrations give equal choices */
/* Trials run a configuration for a few frames to measure its time, and may exceed the budget.
 * Default: at any time. TRIALS_AT_CUTS: only in frames with DERMIS_FRAME_RESET_HISTORY. NO_TRIALS:
 * never. */
#define DERMIS_BUDGET_TRIALS_AT_CUTS 0x2u
#define DERMIS_BUDGET_NO_TRIALS 0x4u
/* The budget is for one frame of all views of the graph together. It is divided so that the sum of
 * their expected squared errors is least; the division is recomputed at most once per second, and
 * at once if a view comes or goes or the budget changes. Each view gets at least what its cheapest
 * configuration needs, if the budget suffices for all. After eight missed frames, a view's part
 * goes to the other views. */
#define DERMIS_BUDGET_ALL_VIEWS 0x8u

/* Device time that a frame of one view, or of all views, may take: a fixed part of your frame,
 * never the time that other work leaves (docs/choice.md). Each record then picks, for the settings
 * declared with "by": "budget", the options with the least expected error whose expected time fits.
 * All plans that this can select exist from creation on, so changing between them allocates
 * nothing. Times are measured with DERMIS_CONTEXT_TIMINGS; otherwise they come from the
 * calibration. */
typedef struct dermis_budget {
  size_t struct_size;
  float milliseconds; /* per frame, > 0; 0: no budget, choices take their defaults */
  uint32_t flags;     /* DERMIS_BUDGET_.. */
  const dermis_source* errors;      /* error table (docs/choice.md); NULL: unchanged */
  const dermis_source* calibration; /* drops measured times; NULL: unchanged */
  float percentile;   /* fraction of frames that stay within the budget, 0.5..0.99; 0 = 0.95 */
  float uncertainty;  /* factor by which calibrated times may be wrong, 1..100; 0: the file's */
} dermis_budget;
#define DERMIS_BUDGET_INIT {sizeof(dermis_budget), 0, 0, NULL, NULL, 0, 0}
/* Sets the budget for all views, effective at the next record; kept over reload and resize. Costs:
 * time. Thread: concurrent. Errors: ARGUMENT, VERSION, CONFIG, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_set_budget(
    dermis_graph graph, const dermis_budget* budget, dermis_report* report);

/* Work that a frame did not need (dermis_frame_report.skips). */
#define DERMIS_SKIP_NO_MATERIAL 0x1u  /* no profile: the plan has no passes that scatter */
#define DERMIS_SKIP_NO_BOUNDS 0x2u    /* the bounds are empty: no kernel that scatters ran */
#define DERMIS_SKIP_NOTHING_SEEN 0x4u /* no pixel with subsurface: 0 groups are dispatched */
#define DERMIS_SKIP_SUBPIXEL 0x8u     /* tiles that scatter less than a pixel were copied */
#define DERMIS_SKIP_UNIFORM_LIGHT 0x10u  /* tiles in uniform light were copied */
#define DERMIS_SKIP_HISTORY 0x20u     /* history was not read: it, or the previous camera, was invalid */

/* The choice for one frame and its result, for a host to show or log. Strings are valid until the
 * next reload, reload_shaders, resize, set_setting of the graph or the view, set_profile, set_budget
 * or destroy; no other thread may make such a call while they are used. */
typedef struct dermis_frame_report {
  size_t struct_size;
  uint64_t frame_index;      /* of the frame described here */
  const char* configuration; /* for example "technique=sap" */
  const char* reason;        /* why this configuration was chosen; static string */
  const char* miss;          /* why times deviate from the prediction, or ""; static string */
  float budget_ms;           /* of this view; 0: none */
  float predicted_ms;
  float measured_ms;    /* -1: not timed */
  /* RMSE of linear luminance: the light's 99.9th percentile is 1; with a probe, as probed_rmse. */
  float predicted_rmse;
  uint32_t skips;       /* DERMIS_SKIP_.. */
} dermis_frame_report;
#define DERMIS_FRAME_REPORT_INIT {sizeof(dermis_frame_report), 0, NULL, NULL, NULL, 0, 0, 0, 0, 0}
/* Reads the counters of frames up to `completed_frame_index`, as in dermis_frame, and describes the
 * newest frame whose counters were read, by this or an earlier call. After a call that compiles the
 * graph again, earlier frames are described until the next record, which ends the strings; then
 * NOT_READY until a frame recorded since has completed. Costs: none. Thread: one per view. Errors:
 * ARGUMENT, NOT_READY, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_report(
    dermis_view view, uint64_t completed_frame_index, dermis_frame_report* report);

/* Details of the same frame as dermis_frame_report, for tools. Strings have the same lifetime. */
typedef struct dermis_frame_statistics {
  size_t struct_size;
  uint64_t frame_index;
  /* The choice. */
  const char* technique;        /* name in the error table; "" if none runs */
  const char* next_better;      /* the next more accurate configuration; "" for none */
  float next_better_missing_ms; /* time by which next_better exceeds the budget */
  /* predicted_ms + predicted_margin_ms is the time that dermis_budget.percentile of frames keep */
  float predicted_margin_ms;
  float calibrated_ms;          /* time by the calibration for the tiles that were counted */
  uint32_t configuration_count;
  uint32_t switches;   /* since the graph was created */
  uint32_t dispatches; /* recorded work */
  uint64_t groups;     /* workgroups of all dispatches */
  /* 8x8 tiles. */
  uint32_t view_tiles;       /* of the render rectangle */
  uint32_t scattering_tiles; /* that ran the technique */
  uint32_t copied_tiles;     /* that scatter less than a pixel */
  uint32_t uniform_tiles;    /* in uniform light */
  uint32_t sampled_tiles[3]; /* scattering tiles with 8, 16 and 32 samples per pixel */
  uint32_t sample_units;     /* samples taken, in units of 8 samples per pixel of a tile */
  uint32_t sample_demand;    /* the same without a budget */
  float mean_d_px;           /* geometric mean over scattering tiles of the widest d; 0: none */
  /* Fraction of the surface within reach of scattering that leaves the pixels' tangent planes, by
   * subsurface.classify with the setting `relief`; negative: not counted. */
  float mean_relief;
  /* Measured error, by subsurface.probe. */
  uint32_t probed_tiles;  /* 0: error of this frame unknown */
  float probed_rmse;      /* noisy; linear luminance times dermis_frame.exposure */
  float probed_rmse_low;  /* lower end of the 95 % confidence interval */
  float probed_rmse_high; /* upper end; infinity if one tile was probed */
  /* Light through thin parts, by subsurface.transmission_stats: root mean square over tiles with
   * subsurface, linear luminance times dermis_frame.exposure. 0: none, or not counted. */
  float transmitted_rms;
} dermis_frame_statistics;
#define DERMIS_FRAME_STATISTICS_INIT \
  {sizeof(dermis_frame_statistics), 0, NULL, NULL, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, {0, 0, 0}, 0, \
   0, 0, 0, 0, 0, 0, 0, 0}
/* Returns the statistics of the frame that dermis_view_report describes. Costs: none. Thread: one
 * per view. Errors: as there. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_statistics(
    dermis_view view, uint64_t completed_frame_index, dermis_frame_statistics* statistics);
/* Conditions of a forecast. */
typedef struct dermis_forecast_desc {
  size_t struct_size;
  dermis_view view;       /* NULL: the graph's own */
  /* Size of the render rectangle, pixels. 0: as in the frame that dermis_view_report describes. */
  uint32_t width, height;
  float milliseconds;     /* budget of a frame of the view; 0: the present one */
} dermis_forecast_desc;
#define DERMIS_FORECAST_DESC_INIT {sizeof(dermis_forecast_desc), NULL, 0, 0, 0}

/* Expected result of a configuration in frames that show what the newest counted frame showed, at
 * the resolution of the given rectangle. Until tiles are counted, the whole view scatters. */
typedef struct dermis_outcome {
  size_t struct_size;
  const char* configuration; /* lifetime as in dermis_frame_report */
  float expected_ms;         /* with as many samples by tile as fit; without a budget, with all */
  float percentile_ms;       /* that dermis_budget.percentile of frames stay within */
  float expected_rmse;       /* as dermis_frame_report.predicted_rmse */
  uint32_t fits;             /* 1: percentile_ms is within the budget, or there is none */
  uint32_t dominated;        /* 1: another one takes no more time and has no more error */
  /* Device memory of one view of a graph that has only this configuration. */
  uint64_t transient_bytes, history_bytes;
} dermis_outcome;
#define DERMIS_OUTCOME_INIT {sizeof(dermis_outcome), NULL, 0, 0, 0, 0, 0, 0, 0}
/* Returns the outcomes of all configurations, by increasing expected_ms. desc may be NULL. Two-call
 * array. Allocates nothing. Costs: none. Thread: concurrent. Errors: ARGUMENT, VERSION,
 * INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_frontier(
    dermis_graph graph, const dermis_forecast_desc* desc, uint32_t* count,
    dermis_outcome* outcomes);
/* Returns the outcome of the configuration that would run with this rectangle and budget, so that a
 * host can choose its resolution and the budget together (docs/choice.md). Changes nothing and
 * allocates nothing. desc may be NULL. Costs: none. Thread: concurrent. Errors: ARGUMENT,
 * VERSION. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_predict(
    dermis_graph graph, const dermis_forecast_desc* desc, dermis_outcome* outcome);

/* Returns the times measured on this device by the graph's view, as JSON for
 * dermis_budget.calibration at the next start. *size in: capacity of `text`; out: required bytes,
 * including the terminating null. text may be NULL. Costs: time. Thread: concurrent. Errors:
 * ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_calibration(
    dermis_graph graph, size_t* size, char* text);

#ifdef __cplusplus
}
#endif
#endif
