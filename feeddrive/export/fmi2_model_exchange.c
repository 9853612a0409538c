/* FMI 2.0 for model exchange around exported equations of motion. Needs nothing but the C library.
 *
 * fmu_model.h says: MODEL_GUID, MODEL_STATES, MODEL_INPUTS, MODEL_OUTPUTS, MODEL_PARAMETERS, MODEL_FIXED (how many of
 * the parameters, the first ones, may be set before the start alone), MODEL_INDICATORS, MODEL_HELD, MODEL_HELD_SLOPES,
 * MODEL_INDICATE, and the tables MODEL_STATE_DEFAULTS, MODEL_INPUT_DEFAULTS, MODEL_PARAMETER_DEFAULTS, MODEL_NOMINALS,
 * MODEL_HYSTERESIS.
 *
 * Value references: states, their derivatives, inputs, outputs, parameters, each in the order of the tables.
 * Every kink of the equations (flanks of a free play, break-away of a bristle, directions, points of tables) has an
 * indicator g. Between events its branch m is held, 1 where g was above 0, so that the equations are smooth; what is
 * told of it is g shifted by the hysteresis to the side that it is on, which is beyond zero where m has to change.
 */
#include <stdlib.h>
#include <string.h>

#include "fmu_model.h"

#if defined(_WIN32)
#define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

/* The types of the standard, section 2.1.2. */
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef struct {
  void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
  void *(*allocateMemory)(size_t, size_t);
  void (*freeMemory)(void *);
  void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
  fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;
typedef struct {
  fmi2Boolean newDiscreteStatesNeeded;
  fmi2Boolean terminateSimulation;
  fmi2Boolean nominalsOfContinuousStatesChanged;
  fmi2Boolean valuesOfContinuousStatesChanged;
  fmi2Boolean nextEventTimeDefined;
  fmi2Real nextEventTime;
} fmi2EventInfo;

enum {
  FIRST_DERIVATIVE = MODEL_STATES,
  FIRST_INPUT = 2 * MODEL_STATES,
  FIRST_OUTPUT = FIRST_INPUT + MODEL_INPUTS,
  FIRST_PARAMETER = FIRST_OUTPUT + MODEL_OUTPUTS,
  FIRST_TUNABLE = FIRST_PARAMETER + MODEL_FIXED,
  REFERENCES = FIRST_PARAMETER + MODEL_PARAMETERS
};

typedef enum { INSTANTIATED, INITIALIZING, EVENT, CONTINUOUS, TERMINATED } Mode;

typedef struct {
  Mode mode;
  fmi2Real time;
  fmi2Real x[MODEL_STATES];
  fmi2Real u[MODEL_INPUTS];
  fmi2Real p[MODEL_PARAMETERS];
  fmi2Real m[MODEL_INDICATORS + 1];
  fmi2CallbackFunctions callbacks;
  char *name;
} Instance;

static fmi2Status refuse(const Instance *instance, fmi2String text) {
  if (instance->callbacks.logger)
    instance->callbacks.logger(instance->callbacks.componentEnvironment, instance->name, fmi2Error, "error", text);
  return fmi2Error;
}

static void set_defaults(Instance *instance) {
  instance->mode = INSTANTIATED;
  instance->time = 0;
  memcpy(instance->x, MODEL_STATE_DEFAULTS, sizeof instance->x);
  memcpy(instance->u, MODEL_INPUT_DEFAULTS, sizeof instance->u);
  memcpy(instance->p, MODEL_PARAMETER_DEFAULTS, sizeof instance->p);
}

/* Branches as the indicators say: all of them anew, or those that have passed their hysteresis. */
static void take_branches(Instance *instance, int anew) {
  fmi2Real g[MODEL_INDICATORS + 1];
  size_t i;
  MODEL_INDICATE(instance->time, instance->x, instance->u, instance->p, g);
  for (i = 0; i < MODEL_INDICATORS; ++i) {
    fmi2Real beyond = instance->m[i] > 0 ? -g[i] : g[i];
    if (anew) instance->m[i] = g[i] > 0 ? 1 : 0;
    else if (beyond > 0) instance->m[i] = 1 - instance->m[i];
  }
}

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

FMI2_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  Instance *instance = calloc(1, sizeof(Instance));
  (void)resources;
  (void)visible;
  (void)logging;
  if (!instance) return NULL;
  if (callbacks) instance->callbacks = *callbacks;
  instance->name = calloc(1, (name ? strlen(name) : 0) + 1);
  if (instance->name && name) strcpy(instance->name, name);
  set_defaults(instance);
  if (instance->name && type == fmi2ModelExchange && guid && strcmp(guid, MODEL_GUID) == 0) return instance;
  refuse(instance, type == fmi2ModelExchange ? "the GUID is not that of this model" : "only model exchange is offered");
  free(instance->name);
  free(instance);
  return NULL;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component component) {
  if (!component) return;
  free(((Instance *)component)->name);
  free(component);
}

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean logging, size_t count,
                                           const fmi2String categories[]) {
  (void)component;
  (void)logging;
  (void)count;
  (void)categories;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
  (void)tolerance_defined;
  (void)tolerance;
  (void)stop_defined;
  (void)stop;
  ((Instance *)component)->time = start;
  return fmi2OK;
}

static fmi2Status go(fmi2Component component, int allowed, Mode to, fmi2String otherwise) {
  Instance *instance = component;
  if (!allowed) return refuse(instance, otherwise);
  instance->mode = to;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return go(component, ((Instance *)component)->mode == INSTANTIATED, INITIALIZING, "initialised already");
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  take_branches(component, 1);
  return go(component, ((Instance *)component)->mode == INITIALIZING, EVENT, "not in initialization mode");
}

FMI2_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component component) {
  Mode mode = ((Instance *)component)->mode;
  return go(component, mode == CONTINUOUS || mode == EVENT, EVENT, "event mode before initialization");
}

FMI2_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
  return go(component, ((Instance *)component)->mode == EVENT, CONTINUOUS, "continuous time only from event mode");
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component component) { return go(component, 1, TERMINATED, ""); }

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component component) {
  set_defaults(component);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *info) {
  take_branches(component, 0);
  memset(info, 0, sizeof *info);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean keep, fmi2Boolean *event,
                                                   fmi2Boolean *terminate) {
  (void)component;
  (void)keep;
  *event = 0;
  *terminate = 0;
  return fmi2OK;
}

static void evaluate(Instance *instance, fmi2Real *rate, fmi2Real *y) {
  if (instance->mode == INSTANTIATED || instance->mode == INITIALIZING) take_branches(instance, 1);
  MODEL_HELD(instance->time, instance->x, instance->u, instance->p, instance->m, rate, y);
}

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                   fmi2Real values[]) {
  Instance *instance = component;
  fmi2Real rate[MODEL_STATES], y[MODEL_OUTPUTS];
  size_t i;
  evaluate(instance, rate, y);
  for (i = 0; i < count; ++i) {
    fmi2ValueReference at = references[i];
    if (at < FIRST_DERIVATIVE) values[i] = instance->x[at];
    else if (at < FIRST_INPUT) values[i] = rate[at - FIRST_DERIVATIVE];
    else if (at < FIRST_OUTPUT) values[i] = instance->u[at - FIRST_INPUT];
    else if (at < FIRST_PARAMETER) values[i] = y[at - FIRST_OUTPUT];
    else if (at < REFERENCES) values[i] = instance->p[at - FIRST_PARAMETER];
    else return refuse(instance, "no such variable");
  }
  return fmi2OK;
}

static fmi2Status set_real(Instance *instance, fmi2ValueReference at, fmi2Real value) {
  int before_start = instance->mode == INSTANTIATED || instance->mode == INITIALIZING;
  if (at < FIRST_DERIVATIVE) {
    if (!before_start) return refuse(instance, "a state is set by fmi2SetReal before the start alone");
    instance->x[at] = value;
  } else if (at >= FIRST_INPUT && at < FIRST_OUTPUT) {
    instance->u[at - FIRST_INPUT] = value;
  } else if (at >= FIRST_PARAMETER && at < REFERENCES) {
    if (!before_start && at < FIRST_TUNABLE) return refuse(instance, "a fixed parameter is set before the start alone");
    if (!before_start && instance->mode != EVENT) return refuse(instance, "a parameter is set in event mode alone");
    instance->p[at - FIRST_PARAMETER] = value;
  } else {
    return refuse(instance, "only start values, inputs and parameters can be set");
  }
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                                   const fmi2Real values[]) {
  size_t i;
  for (i = 0; i < count; ++i) {
    fmi2Status status = set_real(component, references[i], values[i]);
    if (status != fmi2OK) return status;
  }
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time) {
  ((Instance *)component)->time = time;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real x[], size_t count) {
  Instance *instance = component;
  if (count != MODEL_STATES) return refuse(instance, "another number of states");
  memcpy(instance->x, x, sizeof instance->x);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real x[], size_t count) {
  Instance *instance = component;
  if (count != MODEL_STATES) return refuse(instance, "another number of states");
  memcpy(x, instance->x, sizeof instance->x);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real nominals[], size_t count) {
  if (count != MODEL_STATES) return refuse(component, "another number of states");
  memcpy(nominals, MODEL_NOMINALS, sizeof(fmi2Real) * MODEL_STATES);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real rate[], size_t count) {
  fmi2Real y[MODEL_OUTPUTS];
  if (count != MODEL_STATES) return refuse(component, "another number of states");
  evaluate(component, rate, y);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real indicators[], size_t count) {
  Instance *instance = component;
  fmi2Real g[MODEL_INDICATORS + 1];
  size_t i;
  if (count != MODEL_INDICATORS) return refuse(component, "another number of event indicators");
  MODEL_INDICATE(instance->time, instance->x, instance->u, instance->p, g);
  for (i = 0; i < count; ++i)
    indicators[i] = instance->m[i] > 0 ? g[i] + MODEL_HYSTERESIS[i] : g[i] - MODEL_HYSTERESIS[i];
  return fmi2OK;
}

/* Sum of slope times seed; the slopes of row `of` with states and inputs lie side by side in two matrices. */
FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference unknown[],
                                                    size_t unknowns, const fmi2ValueReference known[], size_t knowns,
                                                    const fmi2Real seed[], fmi2Real result[]) {
  Instance *instance = component;
  fmi2Real a[MODEL_STATES * MODEL_STATES], b[MODEL_STATES * MODEL_INPUTS];
  fmi2Real c[MODEL_OUTPUTS * MODEL_STATES], d[MODEL_OUTPUTS * MODEL_INPUTS];
  size_t i, j;
  if (instance->mode == INSTANTIATED || instance->mode == INITIALIZING) take_branches(instance, 1);
  MODEL_HELD_SLOPES(instance->time, instance->x, instance->u, instance->p, instance->m, a, b, c, d);
  for (i = 0; i < unknowns; ++i) {
    fmi2ValueReference of = unknown[i];
    int rate = of >= FIRST_DERIVATIVE && of < FIRST_INPUT, output = of >= FIRST_OUTPUT && of < FIRST_PARAMETER;
    const fmi2Real *by_state = rate ? a : c, *by_input = rate ? b : d;
    if (!rate && !output) return refuse(instance, "slopes are known of derivatives and outputs alone");
    by_state += (of - (rate ? FIRST_DERIVATIVE : FIRST_OUTPUT)) * MODEL_STATES;
    by_input += (of - (rate ? FIRST_DERIVATIVE : FIRST_OUTPUT)) * MODEL_INPUTS;
    result[i] = 0;
    for (j = 0; j < knowns; ++j) {
      fmi2ValueReference to = known[j];
      if (to < FIRST_DERIVATIVE) result[i] += by_state[to] * seed[j];
      else if (to >= FIRST_INPUT && to < FIRST_OUTPUT) result[i] += by_input[to - FIRST_INPUT] * seed[j];
      else return refuse(instance, "slopes are known with respect to states and inputs alone");
    }
  }
  return fmi2OK;
}

/* What the model does not have: other types, and states that can be put aside. */

#define NOTHING_TO_GET(NAME, TYPE)                                                                             \
  FMI2_EXPORT fmi2Status NAME(fmi2Component component, const fmi2ValueReference references[], size_t count,    \
                              TYPE values[]) {                                                                 \
    (void)references;                                                                                          \
    (void)values;                                                                                              \
    return count == 0 ? fmi2OK : refuse(component, "all variables are of type Real");                          \
  }

NOTHING_TO_GET(fmi2GetInteger, fmi2Integer)
NOTHING_TO_GET(fmi2GetBoolean, fmi2Boolean)
NOTHING_TO_GET(fmi2GetString, fmi2String)
NOTHING_TO_GET(fmi2SetInteger, const fmi2Integer)
NOTHING_TO_GET(fmi2SetBoolean, const fmi2Boolean)
NOTHING_TO_GET(fmi2SetString, const fmi2String)

#define NOT_OFFERED(NAME, ARGUMENTS) \
  FMI2_EXPORT fmi2Status NAME ARGUMENTS { return refuse(component, "states cannot be put aside"); }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
NOT_OFFERED(fmi2GetFMUstate, (fmi2Component component, fmi2FMUstate *state))
NOT_OFFERED(fmi2SetFMUstate, (fmi2Component component, fmi2FMUstate state))
NOT_OFFERED(fmi2FreeFMUstate, (fmi2Component component, fmi2FMUstate *state))
NOT_OFFERED(fmi2SerializedFMUstateSize, (fmi2Component component, fmi2FMUstate state, size_t *size))
NOT_OFFERED(fmi2SerializeFMUstate, (fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size))
NOT_OFFERED(fmi2DeSerializeFMUstate,
            (fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state))
