// Pressure on an impermeable wall that moves: that of the cell, carried on to the face's centre.
// Along the normal it changes by
//
//     dp/dn = -n . dU/dt
//
// of the wall's own velocity, along the wall by the cell's own gradient. The pressure's equation
// sees no gradient there, as with zeroGradient: the wall's flux is given. What the wall's value
// enters is the gradient in the cells beside it, of which zeroGradient takes away up to half; their
// velocities then lag behind the fluxes, and what is convected from them wears a wave down. Without
// the part along the wall the pressure is of first order where cells lean: 6 per cent of a wave's
// omega^2 on a lens of liquid.

#include "addToRunTimeSelectionTable.H"
#include "fvPatchFieldMapper.H"
#include "gaussGrad.H"
#include "volFields.H"
#include "zeroGradientFvPatchFields.H"

namespace Foam
{

class acceleratingWallPressureFvPatchScalarField
:
    public zeroGradientFvPatchScalarField
{
    typedef acceleratingWallPressureFvPatchScalarField This;
    typedef zeroGradientFvPatchScalarField Base;
    typedef DimensionedField<scalar, volMesh> Inner;

    //- n . dU/dt of the wall, as "backward" has it, Euler's in a run's first step
    //  A run starts at rest: its start is not asked, as a restarted solver has lost it there.
    tmp<scalarField> acceleration(const volVectorField& U) const
    {
        const Time& time = U.time();
        const label patch = this->patch().index();
        const scalar dt = time.deltaTValue(), dt0 = time.deltaT0Value();
        const scalar more = time.timeIndex() > 1 ? dt/(dt + dt0) : 0;
        vectorField change((1 + more)*U.boundaryField()[patch]);
        if (time.timeIndex() > 1)
        {
            change -= (1 + dt/dt0)*U.oldTime().boundaryField()[patch];
        }
        if (time.timeIndex() > 2)
        {
            change += more*dt/dt0*U.oldTime().oldTime().boundaryField()[patch];
        }
        return (this->patch().nf() & change)/dt;
    }

    //- From a cell's centre to its face's, the part along the wall, no longer than that across
    //  None where the cell has two walls: its gradient is that of their own values.
    tmp<vectorField> aside() const
    {
        const fvPatch& patch = this->patch();
        labelList walls(this->internalField().size(), 0);
        for (const fvPatch& other : patch.boundaryMesh())
        {
            if (other.coupled()) continue;
            for (const label cell : other.faceCells()) ++walls[cell];
        }
        const vectorField normal(patch.nf()), reach(patch.Cf() - patch.Cn());
        const scalarField across(normal & reach);
        tmp<vectorField> found(reach - across*normal);
        vectorField& along = found.ref();
        along *= min(scalar(1), mag(across)/(mag(along) + VSMALL));
        forAll(along, face)
        {
            if (walls[patch.faceCells()[face]] > 1) along[face] = Zero;
        }
        return found;
    }

public:

    TypeName("acceleratingWallPressure");

    acceleratingWallPressureFvPatchScalarField(const fvPatch& patch, const Inner& inner)
    :
        Base(patch, inner)
    {}

    acceleratingWallPressureFvPatchScalarField
    (
        const fvPatch& patch,
        const Inner& inner,
        const dictionary& dict
    )
    :
        Base(patch, inner, dict)
    {
        if (dict.found("value"))
        {
            fvPatchScalarField::operator=(scalarField("value", dict, patch.size()));
        }
    }

    acceleratingWallPressureFvPatchScalarField
    (
        const This& from,
        const fvPatch& patch,
        const Inner& inner,
        const fvPatchFieldMapper& mapper
    )
    :
        Base(from, patch, inner, mapper)
    {}

#if OPENFOAM < 2606  // later ones copy no field without the inner one
    acceleratingWallPressureFvPatchScalarField(const This& from)
    :
        Base(from)
    {}

    virtual tmp<fvPatchScalarField> clone() const
    {
        return tmp<fvPatchScalarField>(new This(*this));
    }
#endif

    acceleratingWallPressureFvPatchScalarField(const This& from, const Inner& inner)
    :
        Base(from, inner)
    {}

    virtual tmp<fvPatchScalarField> clone(const Inner& inner) const
    {
        return tmp<fvPatchScalarField>(new This(*this, inner));
    }

    virtual void evaluate(const Pstream::commsTypes commsType)
    {
        Base::evaluate(commsType);
        if (this->internalField().mesh().moving())
        {
            const volVectorField& U = this->db().lookupObject<volVectorField>("U");
            Field<scalar>::operator-=(acceleration(U)/this->patch().deltaCoeffs());
            // Plain means, as the coupler has them. Between processors they are of the evaluation
            // before.
            const volScalarField& p = refCast<const volScalarField>(this->internalField());
            const volVectorField slope(fv::gaussGrad<scalar>(p.mesh()).grad(p));
            Field<scalar>::operator+=
            (
                aside() & vectorField(slope, this->patch().faceCells())
            );
        }
    }

    //- Written for the momentum predictor of the next step
    virtual void write(Ostream& os) const
    {
        fvPatchScalarField::write(os);
        writeEntry("value", os);
    }
};

makePatchTypeField(fvPatchScalarField, acceleratingWallPressureFvPatchScalarField);

} // End namespace Foam
