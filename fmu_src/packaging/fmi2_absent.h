/* The functions of model exchange, of an FMU that has none. They are there since some tools look every symbol up. */

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define ABSENT(NAME, PARAMETERS)                                                                                       \
    fmi2Status NAME PARAMETERS { return say(c, fmi2Error, #NAME ": this FMU is for co-simulation only"); }

ABSENT(fmi2EnterEventMode, (fmi2Component c))
ABSENT(fmi2NewDiscreteStates, (fmi2Component c, fmi2EventInfo *info))
ABSENT(fmi2EnterContinuousTimeMode, (fmi2Component c))
ABSENT(fmi2CompletedIntegratorStep, (fmi2Component c, fmi2Boolean no_set, fmi2Boolean *event, fmi2Boolean *terminate))
ABSENT(fmi2SetTime, (fmi2Component c, fmi2Real time))
ABSENT(fmi2SetContinuousStates, (fmi2Component c, const fmi2Real x[], size_t n))
ABSENT(fmi2GetDerivatives, (fmi2Component c, fmi2Real dx[], size_t n))
ABSENT(fmi2GetEventIndicators, (fmi2Component c, fmi2Real z[], size_t n))
ABSENT(fmi2GetContinuousStates, (fmi2Component c, fmi2Real x[], size_t n))
ABSENT(fmi2GetNominalsOfContinuousStates, (fmi2Component c, fmi2Real x[], size_t n))
